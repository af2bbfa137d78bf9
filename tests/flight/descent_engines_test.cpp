// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/descent_engines.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_descent_engines_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("engines answer the timeline when they start to run and when they stop, once", "[devices][R14][R50]") {
    test::Spoken<DescentEngines> engines{ModuleId::descent_engines};
    CHECK(engines.on(EngineReply{false, 0.0}).sent<ActionReply>().empty());
    const ActionReply runs{ReplyKind::engines, 1}, stopped{ReplyKind::engines, 0};
    CHECK(engines.on(EngineReply{true, 9000.0}).sent<ActionReply>() == std::vector{runs});
    CHECK(engines.on(EngineReply{true, 9000.0}).sent<ActionReply>().empty());
    CHECK(engines.recorder.sent<EngineReply>().size() == 1);
    CHECK(engines.on(EngineReply{false, 0.0}).sent<ActionReply>() == std::vector{stopped});
}

TEST_CASE("engines that stop though they are to run are told once", "[devices][R50]") {
    test::Spoken<DescentEngines> engines{ModuleId::descent_engines};
    engines.on(RunEngines{{true, {}}});
    CHECK(engines.on(EngineReply{true, 9000.0}).events<evr::REPLY_CONTRADICTS>() == 0);
    CHECK(engines.on(EngineReply{false, 0.0}).events<evr::REPLY_CONTRADICTS>() == 1);
    CHECK(engines.on(EngineReply{false, 0.0}).events<evr::REPLY_CONTRADICTS>() == 0);
    CHECK(engines.on(EngineReply{true, 9000.0}).events<evr::REPLY_CONTRADICTS>() == 0);
    engines.on(RunEngines{{false, {}}});
    CHECK(engines.on(EngineReply{false, 0.0}).events<evr::REPLY_CONTRADICTS>() == 0);
}

TEST_CASE("a bridle that was released answers the timeline when it begins to pay out, once", "[devices][R14][R50]") {
    test::Spoken<DescentEngines> engines{ModuleId::descent_engines};
    CHECK(engines.on(BridleReply{0.2}).sent<ActionReply>().empty());
    engines.on(PayOutBridle{});
    CHECK(engines.on(BridleReply{0.04}).sent<ActionReply>().empty());
    const auto replies = engines.on(BridleReply{0.06}).sent<ActionReply>();
    REQUIRE(replies.size() == 1);
    CHECK(replies[0] == ActionReply{ReplyKind::bridle, 0});
    CHECK(engines.on(BridleReply{0.1}).sent<ActionReply>().empty());
    CHECK(engines.recorder.sent<BridleReply>().size() == 1);
}

TEST_CASE("throttle and pay-out reach the bus at the turn of the engines' manager", "[devices][R5]") {
    test::Spoken<DescentEngines> engines{ModuleId::descent_engines};
    engines.on(RunEngines{{true, {}}});
    engines.on(PayOutBridle{});
    CHECK_FALSE(engines.recorder.bus->engines.ignited);
    engines.on(Tick{Sclk{1.0}});
    CHECK(engines.recorder.bus->engines.ignited);
    CHECK(engines.recorder.bus->pay_out_bridle);
}

TEST_CASE("the engines' manager confirms each tick and addresses the selected controller", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<DescentEngines>(ModuleId::descent_engines, Device::descent_engines));
}

}  // namespace flight_descent_engines_test
