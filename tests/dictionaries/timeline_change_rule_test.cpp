// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_change_rule.hpp"

#include "tests/support/catch.hpp"

#include <vector>

namespace dictionaries_timeline_change_rule_test {

using namespace aeolis;
using namespace aeolis::timeline;

namespace {

using Why = Unsafe::Why;

constexpr AnchorId root{0}, entry{1}, gnc{2};

struct Constraint {
    Moment from, to;
    MaybeOffset minimum_s, maximum_s;
};

/// Eight rows, ten seconds apart on `entry`, then one that GNC starts and one 5 s after it.
struct Plan {
    std::vector<Offsets> all;
    std::vector<std::optional<double>> timeouts;
    std::vector<bool> essential;
    MaybeOffset entry_s = 1000.0, gnc_s;
    std::vector<Constraint> bounds;

    Plan() {
        for (int i = 0; i < 8; ++i) all.push_back({entry, -100.0 + 10.0 * i, 0.0});
        all.push_back({gnc, 0.0, 0.0});
        all.push_back({gnc, 5.0, 0.0});
        timeouts.resize(all.size());
        essential.resize(all.size(), true);
        bounds.push_back({Moment::of_anchor(entry), Moment::of_anchor(gnc), 20.0, {}});
        bounds.push_back({Moment::of_anchor(gnc), Moment::of_triggered(TimepointId{8}), 0.0, 0.0});
    }
    std::size_t rows() const { return all.size(); }
    Offsets offsets(std::size_t row) const { return all[row]; }
    std::optional<double> reply_timeout_s(std::size_t row) const { return timeouts[row]; }
    bool is_essential(std::size_t row) const { return essential[row]; }
    std::size_t anchors() const { return 3; }
    std::optional<AnchorId> parent(std::size_t anchor) const {
        return anchor == 0 ? std::nullopt : std::optional{root};
    }
    MaybeOffset anchor_offset_s(std::size_t anchor) const { return anchor == entry.value ? entry_s : gnc_s; }
    bool is_decided_in_flight(std::size_t anchor) const { return anchor == gnc.value; }
    const std::vector<Constraint>& constraints() const { return bounds; }
};

/// Begun at 800 s, and all before `current` fired when the plan has them.
struct Stand {
    Plan plan{};
    Standing at{.now = Sclk{850.0}, .current = 0, .waiting = false, .previous_fired = Sclk{800.0}};
    Times known{};

    void fired_until(std::size_t current, double now_s) {
        for (std::size_t i = at.current; i < current; ++i)
            known.triggered[i] = known.fired[i] = at.previous_fired = Sclk{*plan.entry_s + *plan.all[i].desired_s};
        at.current = current;
        at.now = Sclk{now_s};
    }
    std::optional<Unsafe> judge(const Change& change) const {
        Times before = known, after = known;
        return unsafe_change(plan, change, at, before, after);
    }
    std::optional<Why> why(const Change& change) const {
        const auto unsafe = judge(change);
        return unsafe ? std::optional{unsafe->why} : std::nullopt;
    }
};

TimepointChange timepoint(std::uint16_t id, double desired_s) {
    return {TimepointId{id}, desired_s, 0.0};
}

}  // namespace

TEST_CASE("what fires is projected by the rule: each timepoint as soon as it may, at most five in a cycle",
          "[timeline][R51]") {
    Stand s;
    for (auto& row : s.plan.all) row.desired_s = -900.0;  // overdue, all of them
    Times times;
    project(s.plan, s.at, Replies::at_once, nullptr, times);
    for (std::size_t i = 0; i < 8; ++i)
        CHECK(times.triggered[i].get() == Sclk{850.0 + (i < triggered_per_cycle_max ? 0.0 : seconds_per_tick)});
}

TEST_CASE("a reply comes at once or at its time-out, and one that is due holds what follows", "[timeline][R51]") {
    Stand s;
    s.plan.timeouts[0] = 15.0;
    Times times;
    project(s.plan, s.at, Replies::at_timeout, nullptr, times);
    CHECK(times.triggered[0].get() == Sclk{900.0});
    CHECK(times.triggered[1].get() == Sclk{915.0});
    s.at = {.now = Sclk{905.0}, .current = 0, .waiting = true, .previous_fired = Sclk{800.0}};
    times.triggered[0] = Sclk{900.0};
    project(s.plan, s.at, Replies::at_once, nullptr, times);
    CHECK(times.fired[0].get() == Sclk{905.0});
    CHECK(times.triggered[1].get() == Sclk{910.0});
}

TEST_CASE("what GNC is still to decide comes as early as it is given, and not before now", "[timeline][R51]") {
    Stand s;
    Times times;
    project(s.plan, s.at, Replies::at_once, nullptr, times);
    CHECK(times.triggered[8].get() == Sclk{1020.0});
    s.fired_until(8, 1300.0);
    project(s.plan, s.at, Replies::at_once, nullptr, times = s.known);
    CHECK(times.triggered[8].get() == Sclk{1300.0});
}

TEST_CASE("a change that the timeline has room for is safe", "[timeline][R51]") {
    Stand s;
    CHECK_FALSE(s.judge(timepoint(3, -75.0)));
    CHECK_FALSE(s.judge(AnchorChange{entry, 995.0}));
    CHECK_FALSE(s.judge(AnchorChange{entry, 1005.0}));
}

TEST_CASE(
    "a change that makes a timepoint overdue is unsafe, to the tick; what is overdue anyway is not held against it",
    "[timeline][R51]") {
    Stand s;
    s.fired_until(2, 912.0);
    CHECK_FALSE(s.judge(timepoint(2, -88.0)));  // due at 912 s: now, and not a tick ago
    const auto unsafe = s.judge(timepoint(2, -88.0 - seconds_per_tick));
    REQUIRE(unsafe);
    CHECK(unsafe->why == Why::overdue);
    CHECK(unsafe->what == Moment::of_triggered(TimepointId{2}));
    CHECK(unsafe->by_s == seconds_per_tick);
    s.at.now = Sclk{925.0};
    CHECK_FALSE(s.judge(timepoint(3, -75.0)));  // the third is overdue, change or not
}

TEST_CASE("an anchor moved so that its timepoints are past is unsafe: they would fire in a burst", "[timeline][R51]") {
    Stand s;
    CHECK(s.why(AnchorChange{entry, 500.0}) == Why::overdue);
}

TEST_CASE(
    "more than five timepoints within a second that the plan has apart are unsafe; five are not, nor six that the "
    "plan has together",
    "[timeline][R51]") {
    Stand s;
    const auto squeeze = [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i <= last; ++i) s.plan.all[i].desired_s = -50.0 + 0.125 * static_cast<double>(i);
    };
    squeeze(1, 4);
    CHECK_FALSE(s.judge(timepoint(5, -49.5)));  // the fifth
    squeeze(1, 5);
    const auto unsafe = s.judge(timepoint(6, -49.25));  // the sixth
    REQUIRE(unsafe);
    CHECK(unsafe->why == Why::burst);
    CHECK(unsafe->what == Moment::of_triggered(TimepointId{6}));
    CHECK_FALSE(s.judge(timepoint(6, -49.875 + burst_s)));  // a whole second after the first
    squeeze(1, 6);
    CHECK_FALSE(s.judge(timepoint(7, -29.0)));
}

TEST_CASE("what has fired counts: five that fired within the last second and one more are a burst", "[timeline][R51]") {
    Stand s;
    for (std::size_t i = 0; i < 5; ++i) s.plan.all[i].desired_s = -100.0 + 0.125 * static_cast<double>(i);
    s.fired_until(5, 900.75);
    CHECK(s.why(timepoint(5, -99.125)) == Why::burst);
    CHECK_FALSE(s.judge(timepoint(5, -99.0)));
}

TEST_CASE("a constraint that a change would break is named, with by how much and which way; one already broken is not",
          "[timeline][R19][R51]") {
    Stand s;
    s.plan.bounds.push_back({Moment::of_fired(TimepointId{2}), Moment::of_triggered(TimepointId{3}), 8.0, 12.0});
    CHECK_FALSE(s.judge(timepoint(3, -72.0)));
    const auto soon = s.judge(timepoint(3, -73.0)), late = s.judge(timepoint(3, -67.5));
    REQUIRE(soon);
    CHECK((soon->why == Why::too_soon && soon->by_s == 1.0 && soon->constraint == 2U));
    REQUIRE(late);
    CHECK((late->why == Why::too_late && late->by_s == 0.5 && late->constraint == 2U));
    s.plan.all[3].desired_s = -73.0;
    CHECK_FALSE(s.judge(timepoint(4, -61.0)));           // broken as before
    CHECK(s.why(timepoint(3, -74.0)) == Why::too_soon);  // and more so
}

TEST_CASE("a constraint counts from what has fired, when it did", "[timeline][R51]") {
    Stand s;
    s.plan.bounds.push_back({Moment::of_fired(TimepointId{0}), Moment::of_triggered(TimepointId{1}), 8.0, {}});
    s.fired_until(1, 902.0);
    s.known.fired[0] = Sclk{901.0};
    CHECK_FALSE(s.judge(timepoint(1, -91.0)));
    CHECK(s.why(timepoint(1, -92.0)) == Why::too_soon);
}

TEST_CASE("a constraint is judged with late replies as with early ones", "[timeline][R51]") {
    Stand s;
    s.plan.timeouts[2] = 4.0;
    s.plan.bounds.push_back({Moment::of_fired(TimepointId{2}), Moment::of_triggered(TimepointId{3}), 3.0, {}});
    CHECK_FALSE(s.judge(timepoint(3, -73.0)));
    CHECK(s.why(timepoint(3, -74.0)) == Why::too_soon);  // 6 s after the triggering, and 2 s after a late reply
}

TEST_CASE("what Second Chance does without may break a constraint: flight watches it, and nothing rests on it",
          "[timeline][R39][R51]") {
    Stand s;
    s.plan.bounds.push_back({Moment::of_fired(TimepointId{2}), Moment::of_triggered(TimepointId{3}), 8.0, {}});
    s.plan.essential[3] = false;
    CHECK_FALSE(s.judge(timepoint(3, -79.0)));
}

TEST_CASE("nothing may hold up what GNC starts, by however little", "[timeline][R51]") {
    Stand s;
    CHECK_FALSE(s.judge(timepoint(7, 20.0)));
    CHECK(s.why(timepoint(7, 20.0 + seconds_per_tick)) == Why::too_late);
    CHECK(s.why(AnchorChange{entry, 1060.0}) == Why::too_late);  // the rows on entry stand in its way
    CHECK(s.why(timepoint(8, 1.0)) == Why::too_late);
    CHECK(s.why(timepoint(8, -1.0)) == Why::too_soon);
}

TEST_CASE("an anchor that GNC decides is not ground's to move, decided or not", "[timeline][R51]") {
    Stand s;
    CHECK(s.why(AnchorChange{gnc, 1100.0}) == Why::decided_in_flight);
    s.plan.gnc_s = 1040.0;
    CHECK(s.why(AnchorChange{gnc, 1040.0}) == Why::decided_in_flight);
}

TEST_CASE("a timepoint that was triggered is past changing", "[timeline][R51]") {
    Stand s;
    s.fired_until(2, 912.0);
    CHECK(s.why(timepoint(1, -85.0)) == Why::triggered_already);
    CHECK_FALSE(s.judge(timepoint(2, -79.0)));
    s.at.waiting = true;
    s.known.triggered[2] = Sclk{912.0};
    CHECK(s.why(timepoint(2, -79.0)) == Why::triggered_already);
}

TEST_CASE("before do edl a change is judged as though it came now", "[timeline][R51]") {
    Stand s;
    s.at.previous_fired = {};
    s.plan.bounds.push_back({Moment::of_do_edl(), Moment::of_anchor(entry), 100.0, {}});
    CHECK_FALSE(s.judge(AnchorChange{entry, 950.0}));
    CHECK(s.why(AnchorChange{entry, 949.0}) == Why::overdue);
    s.plan.all.front().desired_s = s.plan.all.front().desired_s.value() + 5.0;
    CHECK(s.why(AnchorChange{entry, 945.0}) == Why::too_soon);
}

TEST_CASE("an offset that is not defined ends what is foreseen, and nothing behind it is judged",
          "[timeline][R13][R51]") {
    Stand s;
    s.plan.all[4].desired_s = {};
    Times times;
    project(s.plan, s.at, Replies::at_once, nullptr, times);
    CHECK(times.triggered[3].defined());
    for (std::size_t i = 4; i < s.plan.rows(); ++i) CHECK_FALSE(times.triggered[i].defined());
    CHECK_FALSE(s.judge(timepoint(6, -41.0)));
}

TEST_CASE("entry is said no farther from where it is navigated than is allowed, and not at all where it is not",
          "[timeline][R51]") {
    const Sclk navigated{1000.0};
    for (const double off_s : {-10.0, 0.0, 10.0}) CHECK_FALSE(unsafe_entry(entry, navigated + off_s, navigated, 10.0));
    for (const double off_s : {-10.015625, 10.015625, 300.0}) {
        const auto unsafe = unsafe_entry(entry, navigated + off_s, navigated, 10.0);
        REQUIRE(unsafe);
        CHECK((unsafe->why == Why::not_navigated && unsafe->by_s == off_s));
    }
    CHECK(unsafe_entry(entry, navigated, {}, 10.0));
}

}  // namespace dictionaries_timeline_change_rule_test
