// SPDX-License-Identifier: Apache-2.0
#include "commands/encoder.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

#include <cmath>
#include <limits>
#include <random>

namespace commands_encoder_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

const dictionary::Dictionary& mission() {
    static const auto dictionary = tests::small_dictionary();
    return dictionary;
}
const dictionary::Command& set_parameters() {
    return *mission().command("EDL_SET_PARAMETERS");
}
std::string refusal(const dictionary::Command& command, std::vector<NamedValue> arguments) {
    const auto packet = encode(command, arguments, 0);
    REQUIRE_FALSE(packet.ok());
    return packet.error().message;
}
std::vector<NamedValue> with(std::string name, double value) {
    std::vector<NamedValue> arguments{{"solution_id", 3}, {"entry_sclk", 1000.5}};
    for (auto& argument : arguments)
        if (argument.name == name) {
            argument.value = value;
            return arguments;
        }
    arguments.push_back({std::move(name), value});
    return arguments;
}

}  // namespace

TEST_CASE("a command is a telecommand packet that says what was asked, defaults filled in", "[encoder][R44]") {
    const auto packet = encode(set_parameters(), with("solution_id", 513), 9);
    REQUIRE(packet.ok());
    const auto read = read_tc_packet(*packet);
    REQUIRE(read);
    CHECK(read->primary.apid == telecommand_apid);
    CHECK(read->primary.count == 9);
    CHECK(read->opcode == tests::set_parameters);
    BitReader reader{read->arguments};  // as flight reads it
    CHECK(reader.get(16) == 513);
    CHECK(reader.get_double() == 1000.5);
    CHECK(reader.get_float() == 405.0F);
}

TEST_CASE("a command without arguments is header, opcode and CRC", "[encoder]") {
    const auto packet = encode(*mission().command("NO_OP"), {}, 0);
    REQUIRE(packet.ok());
    CHECK(packet->size() == tc_overhead_octets);
}

TEST_CASE("what cannot be encoded is refused in one sentence that names it", "[encoder][R44]") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(refusal(set_parameters(), with("speed", 1)) == "EDL_SET_PARAMETERS has no argument 'speed'");
    CHECK(refusal(set_parameters(), {{"solution_id", 1}, {"solution_id", 1}, {"entry_sclk", 1}}) ==
          "argument 'solution_id' of EDL_SET_PARAMETERS is given twice");
    CHECK(refusal(set_parameters(), {{"solution_id", 1}}) ==
          "argument 'entry_sclk' of EDL_SET_PARAMETERS is missing: must be from 0 to 4294967295 s");
    CHECK(refusal(set_parameters(), with("parachute_speed_mps", 500)) ==
          "argument 'parachute_speed_mps' of EDL_SET_PARAMETERS is 500 m/s: must be from 380 to 430 m/s");
    CHECK(refusal(set_parameters(), with("entry_sclk", nan)) ==
          "argument 'entry_sclk' of EDL_SET_PARAMETERS is nan s: must be a finite number");
    CHECK(refusal(set_parameters(), with("solution_id", 1.5)) ==
          "argument 'solution_id' of EDL_SET_PARAMETERS is 1.5: must be a whole number");
    CHECK(refusal(set_parameters(), with("solution_id", 0)) ==
          "argument 'solution_id' of EDL_SET_PARAMETERS is 0: must be from 1 to 65535");
}

TEST_CASE("an argument on its bound is sent, one beside it is not", "[encoder]") {
    CHECK(encode(set_parameters(), with("parachute_speed_mps", 380.0), 0).ok());
    CHECK(encode(set_parameters(), with("parachute_speed_mps", 430.0), 0).ok());
    CHECK_FALSE(encode(set_parameters(), with("parachute_speed_mps", std::nextafter(380.0, 0.0)), 0).ok());
    CHECK_FALSE(encode(set_parameters(), with("parachute_speed_mps", std::nextafter(430.0, 999.0)), 0).ok());
}

TEST_CASE("a value that rounding to 32 bits carries out of its range is refused", "[encoder]") {
    dictionary::Command command;
    command.name = "C";
    tests::add_argument(command, "ratio", tests::within(tests::f32("1"), 0.0, 0.1));
    // 0.1 is 0.100000001490116… in 32 bits: flight, which knows the bound as 0.1, would refuse it.
    CHECK(refusal(command, {{"ratio", 0.1}}).find("in 32 bits, must be from 0 to 0.1") != std::string::npos);
    CHECK(encode(command, std::vector<NamedValue>{{"ratio", 0.0999}}, 0).ok());
}

TEST_CASE("enumerations, flags and signed numbers take only what they hold", "[encoder]") {
    dictionary::Command command;
    command.name = "C";
    tests::add_argument(command, "mode", tests::labels(3, {{1, "slow"}, {4, "fast"}}));
    tests::add_argument(command, "on", tests::flag());
    tests::add_argument(command, "offset", tests::number("s", dictionary::Encoding::twos_complement, 12));
    const auto sent = [&](double mode, double on, double offset) {
        return encode(command, std::vector<NamedValue>{{"offset", offset}, {"mode", mode}, {"on", on}}, 0);
    };
    const auto packet = sent(4, 1, -2048);
    REQUIRE(packet.ok());
    CHECK(packet->at(8) == 0b1001'1000);
    CHECK(packet->at(9) == 0);
    CHECK(sent(2, 1, 0).error().message == "argument 'mode' of C is 2: must be one of 1 slow, 4 fast");
    CHECK(sent(1, 2, 0).error().message == "argument 'on' of C is 2: must be 0 or 1");
    CHECK(sent(1, 1, 2048).error().message == "argument 'offset' of C is 2048 s: does not fit 12 bits");
    CHECK_FALSE(sent(1, 1, -2049).ok());
}

TEST_CASE("the largest 64-bit number does not overflow", "[encoder]") {
    dictionary::Command command;
    command.name = "C";
    tests::add_argument(command, "wide", tests::u(64));
    CHECK(refusal(command, {{"wide", std::ldexp(1.0, 64)}}) ==
          "argument 'wide' of C is 18446744073709551616: does not fit 64 bits without sign");
    CHECK(encode(command, std::vector<NamedValue>{{"wide", std::ldexp(1.0, 63)}}, 0).ok());
}

TEST_CASE("random commands read back bit for bit as they were meant", "[encoder][property]") {
    std::mt19937_64 random{1997};
    for (int round = 0; round < 2000; ++round) {
        dictionary::Command command;
        command.name = "C";
        command.opcode = Opcode{static_cast<std::uint16_t>(random())};
        std::vector<NamedValue> arguments;
        const auto count = random() % 12;
        for (std::size_t i = 0; i < count; ++i) {
            const std::string name = "a" + std::to_string(i);
            const unsigned bits = 1 + random() % 52;
            switch (random() % 4) {
            case 0:
                tests::add_argument(command, name, tests::u(bits));
                arguments.push_back({name, static_cast<double>(random() >> (64 - bits))});
                break;
            case 1:
                tests::add_argument(command, name, tests::number("m", dictionary::Encoding::twos_complement, bits));
                arguments.push_back({name, static_cast<double>(static_cast<std::int64_t>(random()) >> (64 - bits))});
                break;
            case 2:
                tests::add_argument(command, name, tests::f32("m"));
                arguments.push_back({name, static_cast<double>(static_cast<float>(random() % 1000000) / 64.0F)});
                break;
            default:
                tests::add_argument(command, name, tests::f64("m"));
                arguments.push_back({name, static_cast<double>(random()) / 3.0 - 1e18});
                break;
            }
        }
        const auto packet = encode(command, arguments, static_cast<std::uint16_t>(round % count_modulus));
        REQUIRE(packet.ok());
        const auto back = decode(command, *packet);
        REQUIRE(back.ok());
        REQUIRE(*back == arguments);
    }
}

TEST_CASE("a packet is read back only as the command that it is", "[encoder]") {
    auto packet = *encode(set_parameters(), with("solution_id", 5), 0);
    CHECK(decode(*mission().command("NO_OP"), packet).error().message == "opcode 258 is not that of NO_OP");
    packet.back() ^= 1;
    CHECK_FALSE(decode(set_parameters(), packet).ok());
    CHECK_FALSE(decode(set_parameters(), {}).ok());
}

TEST_CASE("ground's solution fills what was not given, and nothing that the command lacks", "[encoder][R23]") {
    const std::vector<NamedValue> given{{"solution_id", 9}};
    const std::vector<NamedValue> solution{{"solution_id", 1}, {"entry_sclk", 1000.0}, {"no_such", 1}};
    const auto filled = fill_from_solution(set_parameters(), given, solution);
    CHECK(filled == std::vector<NamedValue>{{"solution_id", 9}, {"entry_sclk", 1000.0}});
    CHECK(arguments_text(filled) == "solution_id=9 entry_sclk=1000");
    CHECK(encode(set_parameters(), filled, 0).ok());
}

TEST_CASE("every command of the shipped dictionary can be sent at its bounds, and not beside them",
          "[encoder][R44][R48]") {
    for (const auto& command : tests::shipped_dictionary().commands) {
        INFO(command.name);
        for (const bool largest : {false, true}) {
            std::vector<NamedValue> arguments;
            for (const auto& argument : command.arguments) {
                const auto& bound = largest ? argument.type.valid_max : argument.type.valid_min;
                const double first = argument.type.enumeration.empty()
                                         ? 0.0
                                         : static_cast<double>(argument.type.enumeration.front().value);
                arguments.push_back({argument.name, bound.value_or(first)});
            }
            const auto packet = encode(command, arguments, 1);
            INFO((packet.ok() ? std::string{} : packet.error().message));
            REQUIRE(packet.ok());
            CHECK(*decode(command, *packet) == arguments);
            for (std::size_t i = 0; i < arguments.size(); ++i) {
                if (!command.arguments[i].type.valid_min || !command.arguments[i].type.valid_max) continue;
                auto outside = arguments;
                const double outwards = largest ? 1e300 : -1e300;
                outside[i].value = std::nextafter(outside[i].value, outwards);
                CHECK_FALSE(encode(command, outside, 1).ok());
            }
        }
    }
}

}  // namespace commands_encoder_test
