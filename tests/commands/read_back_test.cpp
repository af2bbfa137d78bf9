// SPDX-License-Identifier: Apache-2.0
#include "commands/read_back.hpp"

#include "commands/encoder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

#include <cmath>

namespace commands_read_back_test {

using namespace aeolis;
using namespace aeolis::commands;
using aeolis::tests::PacketFiller;

namespace {

struct Ground {
    dictionary::Dictionary dictionary = tests::small_dictionary();
    const dictionary::Command& command = *dictionary.command("EDL_SET_PARAMETERS");
    std::vector<std::uint8_t> sent =
        *encode(command, std::vector<NamedValue>{{"solution_id", 7}, {"entry_sclk", 397501147.4}}, 1);

    ReadBack held(double solution, double entry, double speed) const {
        const auto packet = PacketFiller{dictionary, "ParametersHeld"}
                                .raw("solution_id", static_cast<std::uint64_t>(solution))
                                .real("entry_sclk", entry)
                                .real("parachute_speed_mps", speed)
                                .seal(0, Sclk{397'500'100.0});
        return compare(command, sent, *dictionary.packet("ParametersHeld"), packet);
    }
};

}  // namespace

TEST_CASE("the report of what is held is found by its fields", "[read_back]") {
    const Ground ground;
    CHECK(read_back_packet(ground.dictionary, ground.command) == ground.dictionary.packet("ParametersHeld"));
    CHECK(read_back_packet(ground.dictionary, *ground.dictionary.command("NO_OP")) == nullptr);
    auto wider = ground.command;
    wider.arguments[2].type.bits = 64;
    CHECK(read_back_packet(ground.dictionary, wider) == nullptr);
}

TEST_CASE("equal means every argument, bit for bit", "[read_back][R23]") {
    const Ground ground;
    const auto same = ground.held(7, 397501147.4, 405.0);
    CHECK(same.equal());
    CHECK(same.text() == "3 of 3 arguments equal bit for bit at SCLK 397500100.000");
}

TEST_CASE("each difference is told with what was sent and what is held", "[read_back][R23]") {
    const Ground ground;
    const auto other = ground.held(8, 397501147.4, 404.0);
    CHECK_FALSE(other.equal());
    CHECK(other.text() == "2 of 3 arguments differ at SCLK 397500100.000: solution_id sent 7, held 8; "
                          "parachute_speed_mps sent 405, held 404");
}

TEST_CASE("the last bit of a double is compared too", "[read_back]") {
    const Ground ground;
    const auto other = ground.held(7, std::nextafter(397501147.4, 0.0), 405.0);
    REQUIRE(other.differences.size() == 1);
    CHECK(other.differences[0].argument == "entry_sclk");
    CHECK(other.differences[0].sent != other.differences[0].held);
}

TEST_CASE("comparing packets that are not these is a bug that is found", "[read_back]") {
    const Ground ground;
    const auto& report = *ground.dictionary.packet("ParametersHeld");
    CHECK_THROWS_AS(compare(ground.command, {}, report, {}), CheckFailed);
    CHECK_THROWS_AS(compare(ground.command, ground.sent, report, PacketFiller{ground.dictionary, "Status"}.seal()),
                    CheckFailed);
}

TEST_CASE("the shipped dictionary reports the parameters that it is sent", "[read_back][R23][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto* command = dictionary.command("EDL_SET_PARAMETERS");
    REQUIRE(command != nullptr);
    CHECK(read_back_packet(dictionary, *command) == dictionary.packet("ParametersHeld"));
}

TEST_CASE("an activated table of parameters is read back by version, number and CRC, a staged change by the activation",
          "[read_back][R25][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto report_of = [&](const char* command) {
        return read_back_packet(dictionary, *dictionary.command(command));
    };
    CHECK(report_of("EDL_ACTIVATE_PARAMETERS") == dictionary.packet("ParameterTable"));
    CHECK(report_of("EDL_STAGE_PARAMETER") == nullptr);
    const auto& activation = *dictionary.command("EDL_ACTIVATE_PARAMETERS");
    const auto sent = *encode(
        activation,
        std::vector<NamedValue>{{"parameter_version", 3}, {"parameter_changes", 1}, {"parameter_crc", 0x1234}}, 1);
    for (const std::uint64_t crc : {0x1234, 0x1235}) {
        const auto held = PacketFiller{dictionary, "ParameterTable"}
                              .raw("parameter_version", 3)
                              .raw("parameter_changes", 1)
                              .raw("parameter_crc", crc)
                              .seal(0, Sclk{397'500'100.0});
        CHECK(compare(activation, sent, *dictionary.packet("ParameterTable"), held).equal() == (crc == 0x1234));
    }
}

}  // namespace commands_read_back_test
