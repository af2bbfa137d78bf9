// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/change_guard.hpp"

#include "flight/cross_string/state_exchange.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/edl/decisions.hpp"
#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <array>
#include <set>
#include <vector>

namespace flight_change_guard_test {

using namespace aeolis;
using namespace aeolis::flight;
using Why = timeline::Unsafe::Why;

namespace {

constexpr Sclk entry_time{100'000.0};

/// The shipped timeline, begun, with every reply at its time-out.
struct Fixture {
    Timeline timeline{timeline_specs, anchor_specs};
    ChangeGuard guard{constraint_specs};
    test::OutboxRecorder recorder;
    gnc::Configuration configuration;
    Sclk now = entry_time - 1170.0;

    Fixture() {
        REQUIRE(timeline.set_anchor_offset(anchor::entry, entry_time.seconds));
        timeline.compute_anchors();
        timeline.begin(now);
        guard.begin(now);
    }
    void run_until(Sclk then) {
        for (; now < then; now = now + seconds_per_tick) {
            recorder.begin(ModuleId::edl, now);
            ActionContext context{recorder.out, configuration};
            Firings firings;
            timeline.begin_cycle();
            timeline.pass(now, context, firings);
            guard.watch(timeline, firings.span());
        }
    }
    std::optional<Why> judge(const timeline::Change& change) {
        const auto unsafe = guard.judge(timeline, change, now);
        return unsafe ? std::optional{unsafe->why} : std::nullopt;
    }
    std::optional<Why> offset(TimepointId id, double desired_s) {
        const auto& row = timeline_specs.at(id.value);
        return judge(timeline::TimepointChange{id, desired_s, row.minimum_offset_s});
    }
};

}  // namespace

TEST_CASE("the anchors that the guard keeps for GNC are those that GNC sets", "[timeline][R17][R51]") {
    std::set<std::uint16_t> set_by_gnc, kept;
    for (std::size_t i = 0; i < gnc::trigger_count; ++i)
        if (const auto anchor = anchor_of(static_cast<gnc::Trigger>(i))) set_by_gnc.insert(anchor->value);
    Fixture f;
    for (std::uint16_t i = 1; i < anchor_count; ++i)
        if (f.judge(timeline::AnchorChange{AnchorId{i}, entry_time.seconds}) == Why::decided_in_flight) kept.insert(i);
    CHECK(kept == set_by_gnc);
}

TEST_CASE("offsets set again as they are, are safe at any time until they are used", "[timeline][R51]") {
    Fixture f;
    for (; f.now < entry_time; f.run_until(f.now + 20.0)) {
        INFO(f.now - entry_time);
        CHECK_FALSE(f.judge(timeline::AnchorChange{anchor::entry, entry_time.seconds}));
        const std::size_t first = f.timeline.current().value + (f.timeline.waiting() ? 1 : 0);
        for (std::size_t i = first; i < timepoint_count; ++i)
            CHECK_FALSE(f.offset(TimepointId{static_cast<std::uint16_t>(i)}, *timeline_specs.at(i).desired_offset_s));
    }
}

TEST_CASE("the guard knows what has fired and what time it is", "[timeline][R51]") {
    Fixture f;
    f.run_until(entry_time - 820.0);
    CHECK(f.offset(timepoint::coolant_vent, -815.0) == Why::triggered_already);
    CHECK(f.offset(timepoint::uhf_start, -821.0) == Why::overdue);
    CHECK(f.offset(timepoint::uhf_start, -815.0) == Why::too_soon);  // 20 s after the vent answered, or its time-out
    CHECK_FALSE(f.offset(timepoint::uhf_start, -801.0));
}

TEST_CASE("a guard that gets the state of another judges with what fired there", "[timeline][R33][R51]") {
    Fixture f;
    f.run_until(entry_time - 820.0);
    std::array<std::uint8_t, state_octets_max> octets{};
    StateExchange<std::uint8_t> writing{octets};
    writing(f.guard);
    REQUIRE(writing.ok());
    ChangeGuard& taken_over = f.guard = ChangeGuard{constraint_specs};
    // A new guard does not know that the vent has just answered.
    CHECK_FALSE(f.offset(timepoint::uhf_start, -815.0));
    StateExchange<const std::uint8_t> reading{octets};
    reading(taken_over);
    REQUIRE(reading.ok());
    CHECK(reading.size() == writing.size());
    CHECK(f.offset(timepoint::uhf_start, -815.0) == Why::too_soon);
}

TEST_CASE("entry moved so that timepoints are past is unsafe, and so is entry so late that it holds GNC up",
          "[timeline][R51]") {
    Fixture f;
    for (const double earlier_s : {900.0, 500.0, 350.0}) {
        INFO(earlier_s);
        CHECK(f.judge(timeline::AnchorChange{anchor::entry, (entry_time - earlier_s).seconds}) == Why::overdue);
    }
    CHECK(f.judge(timeline::AnchorChange{anchor::entry, (entry_time + 300.0).seconds}).has_value());
}

TEST_CASE("until separation fault protection keeps its end: the anchor of pre-EDL stays hours before",
          "[timeline][R24][R51]") {
    Fixture f;
    CHECK(f.judge(timeline::AnchorChange{anchor::pre_edl_end, 500.0}) == Why::too_soon);
    CHECK(f.judge(timeline::AnchorChange{anchor::pre_edl_end, -100'000.0}) == Why::too_late);
    CHECK_FALSE(f.judge(timeline::AnchorChange{anchor::pre_edl_end, -14'000.0}));
}

TEST_CASE("whatever of the clock's timepoints is overdue when prime is ordered on, five at most follow in a second",
          "[timeline][R32][R51]") {
    // Up to entry the clock alone makes them due; from there on each waits for what GNC decides when it flies again.
    for (const double stood_by_s : {100.0, 500.0, 3000.0}) {
        for (std::uint16_t row = timepoint::cruise_stage_separation.value; row < timepoint::entry_guidance.value;
             ++row) {
            Timeline timeline{timeline_specs, anchor_specs};
            REQUIRE(timeline.set_anchor_offset(anchor::entry, entry_time.seconds));
            timeline.begin(entry_time - 1170.0);
            test::OutboxRecorder recorder;
            gnc::Configuration configuration;
            std::vector<Sclk> triggered;
            double stood_s = 0.0;
            for (Sclk flown = entry_time - 1170.0; flown < entry_time + 40.0; flown = flown + seconds_per_tick) {
                if (timeline.current().value == row && !timeline.waiting() && stood_s == 0.0) stood_s = stood_by_s;
                const Sclk now = flown + stood_s;
                recorder.begin(ModuleId::edl, now);
                ActionContext context{recorder.out, configuration};
                Firings firings;
                timeline.begin_cycle();
                timeline.pass(now, context, firings);
                for (const Firing& firing : firings) triggered.push_back(firing.triggered);
                if (!timeline.waiting()) continue;
                auto reply = context.awaited();
                reply.evidence = Evidence::verified;
                timeline.reply(reply);
            }
            INFO("stood by for " << stood_by_s << " s at " << timeline_specs[row].name);
            CHECK(timeline.current() == timepoint::entry_guidance);
            for (std::size_t i = 5; i < triggered.size(); ++i) CHECK(triggered[i] - triggered[i - 5] > 1.0);
        }
    }
}

}  // namespace flight_change_guard_test
