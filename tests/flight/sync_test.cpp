// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/sync.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_sync_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Fixture {
    Sync sync{Load{}};
    test::OutboxRecorder recorder{ModuleId::sync};

    template <typename M>
    std::optional<ModuleId> turn_after(const M& message, double at_s) {
        recorder.begin(ModuleId::sync, Sclk{at_s});
        sync.on(message, recorder.out);
        for (const auto& envelope : recorder.out.sent())
            if (std::holds_alternative<Tick>(envelope.message)) return envelope.to;
        return {};
    }
};

}  // namespace

TEST_CASE("sync gives the rate group its turns in the order of the paper, each after a confirmation",
          "[sync][R2][R22]") {
    Fixture f;
    CHECK(f.turn_after(ClockTick{Sclk{0.25}}, 0.25) == ModuleId::radar);
    CHECK(f.turn_after(Confirm{ModuleId::radar}, 0.25) == ModuleId::imu);
    CHECK(f.turn_after(Confirm{ModuleId::imu}, 0.25) == ModuleId::edl);
    CHECK(f.turn_after(Confirm{ModuleId::edl}, 0.25) == ModuleId::pyro);
    CHECK(f.turn_after(Confirm{ModuleId::pyro}, 0.25) == ModuleId::descent_engines);
    CHECK(f.turn_after(Confirm{ModuleId::descent_engines}, 0.25) == ModuleId::thrusters);
    CHECK_FALSE(f.turn_after(Confirm{ModuleId::thrusters}, 0.25).has_value());
    CHECK(f.sync.cycles() == 1);
    CHECK(f.sync.overruns() == 0);
}

TEST_CASE("a tick before the last confirmation is an overrun: reported, counted, the cycle skipped", "[sync][R22]") {
    Fixture f;
    CHECK(f.turn_after(ClockTick{Sclk{0.25}}, 0.25) == ModuleId::radar);
    CHECK_FALSE(f.turn_after(ClockTick{Sclk{0.265625}}, 0.265625).has_value());
    CHECK(f.recorder.events<evr::CYCLE_OVERRUN>() == 1);
    CHECK(f.sync.overruns() == 1);
    CHECK(f.turn_after(Confirm{ModuleId::radar}, 0.265625) == ModuleId::imu);
}

TEST_CASE("a confirmation out of turn is not taken for another's", "[sync][R4][R22]") {
    Fixture f;
    CHECK_FALSE(f.turn_after(Confirm{ModuleId::edl}, 0.25).has_value());
    CHECK(f.turn_after(ClockTick{Sclk{0.25}}, 0.25) == ModuleId::radar);
    CHECK_FALSE(f.turn_after(Confirm{ModuleId::edl}, 0.25).has_value());
    CHECK(f.turn_after(Confirm{ModuleId::radar}, 0.25) == ModuleId::imu);
}

TEST_CASE("messages that found no room are told once, with their number", "[sync][R6]") {
    Fixture f;
    f.sync.set_executive_counts(3, 0);
    (void)f.turn_after(ClockTick{Sclk{0.25}}, 0.25);
    CHECK(f.recorder.events<evr::MAILBOX_OVERFLOW>() == 1);
    (void)f.turn_after(ClockTick{Sclk{0.5}}, 0.5);
    CHECK(f.recorder.events<evr::MAILBOX_OVERFLOW>() == 0);
}

}  // namespace flight_sync_test
