#include "flight/commands/command_dispatcher.hpp"

#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <algorithm>
#include <random>
#include <vector>

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::vector<std::uint8_t> telecommand(Opcode opcode, std::size_t argument_octets, std::uint16_t count = 3) {
    std::vector<std::uint8_t> packet(tc_overhead_octets + argument_octets);
    seal_tc_packet(packet, Apid{1}, count, opcode);
    return packet;
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
    REQUIRE(f.recorder.out.sent().size() == 1);
    CHECK(f.recorder.out.sent()[0].to == ModuleId::edl);
    REQUIRE(f.recorder.sent<DoEdlCommand>().size() == 1);
    CHECK(f.recorder.sent<DoEdlCommand>()[0].tag.count == 9);
    f.handle(CommandOutcome{{command::EDL_DO_EDL::opcode, 9}, CommandRefusal::no_parameters});
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    CHECK(f.recorder.events<evr::COMMAND_ACCEPTED>() == 0);
}

TEST_CASE("an unknown opcode, a wrong length and a bad CRC are refused with their reason", "[commands][R23]") {
    Fixture f;
    f.handle(received(telecommand(Opcode{0x7777}, 0)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    f.handle(received(telecommand(command::EDL_DO_EDL::opcode, 4)));
    CHECK(f.recorder.events<evr::COMMAND_REFUSED>() == 1);
    auto damaged = telecommand(command::NO_OP::opcode, 0);
    damaged.back() ^= 1;
    f.handle(received(damaged));
    CHECK(f.recorder.events<evr::UPLINK_UNREADABLE>() == 1);
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
        if (round % 2 && octets.size() >= tc_overhead_octets)
            seal_tc_packet(octets, Apid{1}, 0, Opcode{static_cast<std::uint16_t>(0x0100 + random() % 8)});
        Fixture f;
        f.handle(received(octets));
        REQUIRE(f.recorder.out.sent().size() >= 1);
        REQUIRE(f.recorder.out.dropped() == 0);
    }
}
