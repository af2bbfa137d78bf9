// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_rule.hpp"

#include "dictionaries/dictionary.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_timeline_rule_test {

using namespace aeolis;
using namespace aeolis::timeline;

TEST_CASE("a timepoint is due once both its offsets have come, exactly at the tick", "[timeline][R11]") {
    const Sclk now{10.0};
    const auto due = [](MaybeOffset desired_s, MaybeOffset minimum_s) {
        return due_times({.anchor = AnchorId{1}, .desired_s = desired_s, .minimum_s = minimum_s}, Sclk{9.0}, Sclk{8.0});
    };
    CHECK(due(2.0, 1.0).have_come(now));
    CHECK_FALSE(due(2.015625, 1.0).have_come(now));
    CHECK_FALSE(due(2.0, 1.015625).have_come(now));
}

TEST_CASE("without an anchor the desired offset counts from the previous firing", "[timeline][R11]") {
    const auto due = due_times({.anchor = {}, .desired_s = 3.0, .minimum_s = 1.0}, Sclk{9.0}, Sclk{100.0});
    CHECK(due.desired.get() == Sclk{12.0});
    CHECK(due.minimum.get() == Sclk{10.0});
}

TEST_CASE("what is undefined never comes", "[timeline][R13]") {
    const Sclk late{1.0e9};
    const Offsets offsets{.anchor = AnchorId{1}, .desired_s = 0.0, .minimum_s = 0.0};
    CHECK(due_times(offsets, Sclk{1.0}, Sclk{1.0}).have_come(late));
    CHECK_FALSE(due_times(offsets, Sclk{1.0}, {}).have_come(late));
    CHECK_FALSE(due_times(offsets, {}, Sclk{1.0}).have_come(late));
    CHECK_FALSE(
        due_times({.anchor = AnchorId{1}, .desired_s = {}, .minimum_s = 0.0}, Sclk{1.0}, Sclk{1.0}).have_come(late));
    CHECK_FALSE(
        due_times({.anchor = AnchorId{1}, .desired_s = 0.0, .minimum_s = {}}, Sclk{1.0}, Sclk{1.0}).have_come(late));
    CHECK_FALSE(anchor_time({}, 1.0).defined());
    CHECK_FALSE(anchor_time(Sclk{1.0}, {}).defined());
}

TEST_CASE("a timepoint fires as it is triggered, or by its time-out at the latest", "[timeline][R14]") {
    CHECK(latest_firing(Sclk{5.0}, {}) == Sclk{5.0});
    CHECK(latest_firing(Sclk{5.0}, 4.0) == Sclk{9.0});
}

TEST_CASE("a constraint holds at both its bounds, and one without a bound always", "[timeline][R19]") {
    const Bounds bounds{.minimum_s = 2.0, .maximum_s = 4.0};
    CHECK(bounds.too_soon(1.984375));
    CHECK_FALSE(bounds.too_soon(2.0));
    CHECK_FALSE(bounds.too_late(4.0));
    CHECK(bounds.too_late(4.015625));
    CHECK_FALSE(Bounds{}.too_soon(-1.0e9));
    CHECK_FALSE(Bounds{}.too_late(1.0e9));
}

TEST_CASE("a row of the dictionary has the rule's offsets and bounds", "[timeline][R11][R19]") {
    dictionary::TimelineRow row;
    row.anchor = AnchorId{2};
    row.desired_offset_s = 3.0;
    row.minimum_offset_s = 1.0;
    const auto offsets = offsets_of(row);
    CHECK((offsets.anchor == AnchorId{2} && offsets.desired_s == 3.0 && offsets.minimum_s == 1.0));
    CHECK(conditions_of(offsets).desired.from == Condition::From::anchor);
    CHECK(conditions_of(offsets).minimum.from == Condition::From::previous_firing);
    dictionary::ConstraintRow constraint;
    constraint.maximum_s = 7.0;
    CHECK((!bounds_of(constraint).minimum_s && bounds_of(constraint).maximum_s == 7.0));
}

}  // namespace dictionaries_timeline_rule_test
