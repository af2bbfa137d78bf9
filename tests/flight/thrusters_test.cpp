// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/thrusters.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_thrusters_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("thrusters are enabled at their turn, and the driver's answer goes to Edl", "[devices][R5][R10][R14]") {
    test::Spoken<Thrusters> thrusters{ModuleId::thrusters};
    thrusters.on(EnableThrusters{true});
    CHECK_FALSE(thrusters.recorder.bus->thrusters_enabled);
    thrusters.on(Tick{Sclk{1.0}});
    CHECK(thrusters.recorder.bus->thrusters_enabled == true);
    thrusters.recorder.bus->begin_cycle();
    thrusters.on(Tick{Sclk{1.0}});
    CHECK_FALSE(thrusters.recorder.bus->thrusters_enabled);
    CHECK(thrusters.on(ThrusterReply{true}).sent<ActionReply>().size() == 1);
}

TEST_CASE("an answer that is not due, from the other driver, a refusal or a contradiction verifies nothing",
          "[devices][R2][R4][R14][R50]") {
    test::Spoken<Thrusters> thrusters{ModuleId::thrusters};
    CHECK(thrusters.on(ThrusterReply{true}).events<evr::REPLY_UNEXPECTED>() == 1);
    thrusters.on(EnableThrusters{false});
    CHECK(thrusters.on(ThrusterReply{false, Unit::b}).events<evr::REPLY_UNEXPECTED>() == 1);
    CHECK(thrusters.on(ThrusterReply{true, Unit::a, true}).events<evr::DEVICE_REFUSED>() == 1);
    const std::vector refused{ActionReply{ReplyKind::thrusters, 0, Evidence::refused, false}};
    CHECK(thrusters.recorder.sent<ActionReply>() == refused);
    thrusters.on(EnableThrusters{false});
    CHECK(thrusters.on(ThrusterReply{true}).events<evr::REPLY_CONTRADICTS>() == 1);
    CHECK(thrusters.recorder.sent<ActionReply>() == refused);
}

TEST_CASE("the answer to an overtaken thruster command is not taken for the newer one's", "[devices][R14]") {
    test::Spoken<Thrusters> thrusters{ModuleId::thrusters};
    thrusters.on(EnableThrusters{false});
    thrusters.on(EnableThrusters{true});
    CHECK(thrusters.on(ThrusterReply{false}).out.sent().empty());
    CHECK(thrusters.on(ThrusterReply{true}).sent<ActionReply>().size() == 1);
}

TEST_CASE("on-times are recorded in each cycle with a pulse, when the last has ended, and with the driver's answer",
          "[devices][R52]") {
    test::Spoken<Thrusters> thrusters{ModuleId::thrusters};
    const auto recorded = [&](const std::vector<Record>& records) {
        std::vector<std::uint64_t> first_on_us;
        for (const Record& record : records)
            if (record.apid == packet::ThrusterPulses::apid) first_on_us.push_back(read_bits(record.data, 0, 16));
        return first_on_us;
    };
    const auto turn = [&] { return recorded(thrusters.on(Tick{Sclk{1.0}}).sent<Record>()); };
    CHECK(turn().empty());
    for (int i = 0; i < 2; ++i) {
        thrusters.on(FireThrusters{{.on_s = {0.0051234, 0.0}}});
        CHECK(turn() == std::vector<std::uint64_t>{5123});
    }
    CHECK(turn() == std::vector<std::uint64_t>{0});
    CHECK(turn().empty());
    thrusters.on(EnableThrusters{true});
    thrusters.on(ThrusterReply{true});
    CHECK(turn() == std::vector<std::uint64_t>{0});
    CHECK(turn().empty());
}

TEST_CASE("the thrusters' manager confirms each tick and addresses the selected driver", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<Thrusters>(ModuleId::thrusters, Device::thrusters));
}

}  // namespace flight_thrusters_test
