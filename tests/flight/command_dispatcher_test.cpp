// SPDX-License-Identifier: Apache-2.0
#include "flight/commands/command_dispatcher.hpp"

#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <random>
#include <vector>

namespace flight_command_dispatcher_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::vector<std::uint8_t> packet_of(Opcode opcode, std::size_t argument_octets, std::uint16_t count = 3) {
    std::vector<std::uint8_t> packet(tc_overhead_octets + argument_octets);
    seal_tc_packet(packet, Apid{1}, count, opcode);
    return packet;
}
std::vector<std::uint8_t> telecommand(Opcode opcode, std::size_t argument_octets, std::uint16_t count = 3) {
    return test::cltu_of(packet_of(opcode, argument_octets, count));
}
std::vector<std::uint8_t> unlock() {
    return test::cltu_of(std::vector<std::uint8_t>{0x00}, {true, true, spacecraft_id, telecommand_channel, 0});
}
/// In sequence.
std::vector<std::uint8_t> no_op_in_frame(std::uint8_t sequence) {
    return test::cltu_of(packet_of(command::NO_OP::opcode, 0),
                         {false, false, spacecraft_id, telecommand_channel, sequence});
}

UplinkReceived received(const std::vector<std::uint8_t>& octets) {
    UplinkReceived uplink;
    uplink.size = static_cast<std::uint16_t>(octets.size());
    std::copy_n(octets.begin(), std::min(octets.size(), uplink.octets.size()), uplink.octets.begin());
    return uplink;
}

struct Fixture {
    CommandDispatcher dispatcher{Load{}};
    test::OutboxRecorder recorder{ModuleId::command_dispatcher};
    template <typename M>
    void handle(const M& message) {
        recorder.begin(ModuleId::command_dispatcher, Sclk{5.0});
        dispatcher.on(message, recorder.out);
    }
};

}  // namespace

TEST_CASE("NO_OP is accepted and executed", "[commands][R44]") {
    Fixture f;
    f.handle(received(telecommand(command::NO_OP::opcode, 0)));
    CHECK(f.recorder.events<evr::COMMAND_ACCEPTED>() == 1);
    CHECK(f.recorder.events<evr::COMMAND_EXECUTED>() == 1);
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 1);
}

TEST_CASE("do edl goes to its one owner, and nothing is claimed before the owner has answered", "[commands][R5][R23]") {
    Fixture f;
    f.handle(received(telecommand(command::EDL_DO_EDL::opcode, 0, 9)));
    REQUIRE(f.recorder.out.sent().size() == 2);
    CHECK(f.recorder.out.sent()[0].to == ModuleId::edl);
    CHECK(f.recorder.out.sent()[1].to == ModuleId::edl_comm);
    REQUIRE(f.recorder.sent<DoEdlCommand>().size() == 1);
    CHECK(f.recorder.sent<DoEdlCommand>()[0].tag.count == 9);
    f.handle(CommandOutcome{{command::EDL_DO_EDL::opcode, 9}, CommandRefusal::no_parameters});
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    CHECK(f.recorder.events<evr::COMMAND_ACCEPTED>() == 0);
}

TEST_CASE("commands of the table of parameters go to EdlBg, which hands them on in their order",
          "[commands][parameters][R25]") {
    Fixture f;
    const auto goes_to_bg = [&](Opcode opcode, std::size_t octets) {
        f.handle(received(telecommand(opcode, octets)));
        return f.recorder.out.sent()[0].to == ModuleId::edl_bg;
    };
    CHECK(goes_to_bg(command::EDL_STAGE_PARAMETER::opcode, command::EDL_STAGE_PARAMETER::argument_octets));
    CHECK(f.recorder.sent<StageParameterCommand>().size() == 1);
    CHECK(goes_to_bg(command::EDL_DISCARD_PARAMETERS::opcode, 0));
    CHECK(f.recorder.sent<DiscardParametersCommand>().size() == 1);
    CHECK(goes_to_bg(command::EDL_DUMP_PARAMETERS::opcode, 0));
    CHECK(f.recorder.sent<DumpParametersCommand>().size() == 1);
    // Version 0 is the table as built: no command names it.
    f.handle(received(
        telecommand(command::EDL_ACTIVATE_PARAMETERS::opcode, command::EDL_ACTIVATE_PARAMETERS::argument_octets)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
}

TEST_CASE("an unknown opcode, a wrong length and a bad CRC are refused with their reason", "[commands][R23]") {
    Fixture f;
    f.handle(received(telecommand(Opcode{0x7777}, 0)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    f.handle(received(telecommand(command::EDL_DO_EDL::opcode, 4)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    auto damaged = telecommand(command::NO_OP::opcode, 0);
    damaged[5] ^= 1;
    f.handle(received(damaged));
    CHECK(f.recorder.events<evr::UPLINK_UNREADABLE>() == 1);
}

TEST_CASE("each answer to a command is explained by the conditions of who decided", "[commands][R5][R38]") {
    Fixture f;
    CommandOutcome outcome{.tag = {command::EDL_DO_EDL::opcode, 9}};
    outcome.conditions.push_back(gnc::is(Quantity::parameters_received, true));
    f.handle(outcome);
    auto told = f.recorder.explanations();
    REQUIRE(told.size() == 1);
    CHECK(told[0].decision == Decision::command);
    CHECK(told[0].verdict == ExplanationVerdict::accepted);
    CHECK(told[0].subject == command::EDL_DO_EDL::opcode.value);
    REQUIRE(told[0].conditions.size() == 1);
    CHECK(told[0].conditions[0].quantity == Quantity::parameters_received);
    outcome.refused = CommandRefusal::inhibited;
    outcome.conditions.push_back(gnc::is(Quantity::fault_inhibit, true, false));
    f.handle(outcome);
    told = f.recorder.explanations();
    REQUIRE(told.size() == 1);
    CHECK(told[0].verdict == ExplanationVerdict::refused);
    CHECK(told[0].conditions.size() == 2);
    f.handle(received(telecommand(command::EDL_DO_EDL::opcode, 4)));
    told = f.recorder.explanations();
    REQUIRE(told.size() == 1);
    REQUIRE(told[0].conditions.size() == 1);
    CHECK(told[0].conditions[0].quantity == Quantity::argument_octets);
    CHECK(told[0].conditions[0].value == 4.0);
    CHECK(told[0].conditions[0].bound == 0.0);
    CHECK_FALSE(told[0].conditions[0].holds);
    f.handle(received(telecommand(Opcode{0x7777}, 0)));
    CHECK(f.recorder.explanations().at(0).conditions.at(0).quantity == Quantity::command_known);
    f.handle(received(telecommand(command::EDL_SET_PARAMETERS::opcode, command::EDL_SET_PARAMETERS::argument_octets)));
    CHECK(f.recorder.explanations().at(0).conditions.at(0).quantity == Quantity::arguments_in_range);
}

TEST_CASE("parameters that are not numbers or out of range are refused whole", "[commands][R23]") {
    Fixture f;
    f.handle(received(telecommand(command::EDL_SET_PARAMETERS::opcode, command::EDL_SET_PARAMETERS::argument_octets)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);  // all zeros: a parachute speed of 0 m/s is out of range
    CHECK(f.recorder.sent<SetParametersCommand>().empty());
}

TEST_CASE("a packet longer than the receiver's buffer is refused", "[commands]") {
    Fixture f;
    f.handle(received(telecommand(command::NO_OP::opcode, 400)));
    CHECK(f.recorder.events<evr::UPLINK_UNREADABLE>() == 1);
}

TEST_CASE("any octets as uplink end in exactly one answer", "[commands][R4]") {
    std::mt19937 random{3};
    for (int round = 0; round < 5000; ++round) {
        std::vector<std::uint8_t> octets(random() % 300);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
        if (round % 2 && octets.size() >= tc_overhead_octets && octets.size() < 200) {
            seal_tc_packet(octets, Apid{1}, 0, Opcode{static_cast<std::uint16_t>(0x0100 + random() % 8)});
            octets = test::cltu_of(octets, {random() % 2 == 0, random() % 4 == 0, spacecraft_id, telecommand_channel,
                                            static_cast<std::uint8_t>(random())});
        }
        Fixture f;
        f.handle(received(octets));
        REQUIRE(f.recorder.out.sent().size() >= 1);
        REQUIRE(f.recorder.out.dropped() == 0);
    }
}

TEST_CASE("frames in sequence are taken once each, and the report says which comes next", "[commands][R44]") {
    Fixture f;
    f.handle(received(no_op_in_frame(0)));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 0);  // not before ground has unlocked the channel
    CHECK(f.recorder.events<evr::UPLINK_FRAME_REFUSED>() == 1);
    f.handle(received(unlock()));
    f.handle(received(no_op_in_frame(0)));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 1);
    REQUIRE(f.recorder.sent<UplinkStatus>().size() == 1);
    CHECK(f.recorder.sent<UplinkStatus>()[0].clcw == word_of({.farm_b = 1, .expected = 1}));
    f.handle(received(no_op_in_frame(0)));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 0);
    CHECK(f.recorder.events<evr::UPLINK_FRAME_REFUSED>() == 1);
    f.handle(received(no_op_in_frame(2)));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 0);
    CHECK(f.recorder.events<evr::UPLINK_FRAME_REFUSED>() == 1);
    REQUIRE(f.recorder.sent<UplinkStatus>().size() == 1);
    CHECK(f.recorder.sent<UplinkStatus>()[0].clcw == word_of({.retransmit = true, .farm_b = 1, .expected = 1}));
    f.handle(received(no_op_in_frame(1)));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 1);
    CHECK(f.recorder.sent<UplinkStatus>()[0].clcw == word_of({.farm_b = 1, .expected = 2}));
}

TEST_CASE("a frame for another spacecraft is not acted on", "[commands][R23]") {
    Fixture f;
    f.handle(received(
        test::cltu_of(packet_of(command::NO_OP::opcode, 0), {true, false, spacecraft_id + 1, telecommand_channel, 0})));
    CHECK(f.recorder.events<evr::NO_OP_EXECUTED>() == 0);
    CHECK(f.recorder.events<evr::UPLINK_FRAME_REFUSED>() == 1);
}

}  // namespace flight_command_dispatcher_test
