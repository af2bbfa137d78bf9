// SPDX-License-Identifier: Apache-2.0
#include "commands/planned_deadlines.hpp"

#include "dictionaries/timeline_plan.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace commands_planned_deadlines_test {

using namespace aeolis;
using commands::PlannedDeadlines;

namespace {

constexpr double light_time_s = 828.0;
constexpr Scet entry{1'000'000'000'000};

Ert before_entry(double seconds) {
    return Ert{entry.microseconds - static_cast<std::int64_t>(seconds * 1.0e6)};
}

std::size_t row_of(const char* name) {
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row = std::ranges::find(timeline, name, &dictionary::TimelineRow::name);
    REQUIRE(row != timeline.end());
    return static_cast<std::size_t>(row - timeline.begin());
}

}  // namespace

TEST_CASE("a command must leave a light time before the next timepoint that is planned after it is there",
          "[gateway][R44]") {
    const auto& words = tests::shipped_dictionary();
    const PlannedDeadlines deadlines{words, entry, light_time_s};
    const auto& command = *words.command("NO_OP");
    const Ert armed = before_entry(828.0 + light_time_s);  // pyros_armed_vent, E-828 s, is planned by the clock
    const auto in_time = deadlines.of(command, {}, Ert{armed.microseconds - 1});
    REQUIRE(in_time);
    CHECK(in_time->timepoint == "pyros_armed_vent");
    CHECK(in_time->latest == armed);
    CHECK(deadlines.of(command, {}, armed)->timepoint ==
          "coolant_vent");  // at that instant it is there together with it: too late
    CHECK(deadlines.next(armed)->timepoint == "coolant_vent");
    CHECK_FALSE(deadlines.next(before_entry(0.0)));  // what is after entry is decided in flight
}

TEST_CASE("a command that changes an offset must be there before what it moves, though other timepoints come first",
          "[gateway][R19][R44]") {
    const auto& words = tests::shipped_dictionary();
    const PlannedDeadlines deadlines{words, entry, light_time_s};
    const std::vector<commands::NamedValue> detumble{{"timepoint", static_cast<double>(row_of("detumble"))}};
    const auto& change = *words.command("EDL_SET_TIMEPOINT_OFFSET");
    const auto deadline = deadlines.of(change, detumble, before_entry(3000.0));
    REQUIRE(deadline);
    CHECK(deadline->timepoint == "detumble");
    CHECK(deadline->latest == before_entry(519.40625 + light_time_s));
    CHECK(deadlines.of(change, detumble, before_entry(600.0)) ==
          deadline);  // it stays what it is when it is too late for it

    // What flight decides itself is where it is predicted; of nothing else one says that it must come before it.
    const std::vector<commands::NamedValue> in_flight{{"timepoint", static_cast<double>(row_of("parachute_deploy"))}};
    const auto predicted = deadlines.of(change, in_flight, before_entry(3000.0));
    REQUIRE(predicted);
    CHECK(predicted->timepoint == "parachute_deploy");
    const auto e_s =
        dictionary::predicted_from_entry_s(words, words.predicted_anchor_e_s, {})[row_of("parachute_deploy")];
    REQUIRE(e_s);
    CHECK(std::abs(static_cast<double>(predicted->latest.microseconds -
                                       before_entry(light_time_s - *e_s).microseconds)) <= 1.0);
}

TEST_CASE("what is planned while a command waits and is on its way is what it is too late for", "[gateway][R44]") {
    const PlannedDeadlines deadlines{tests::shipped_dictionary(), entry, light_time_s};
    const auto missed = deadlines.missed(before_entry(830.0), before_entry(640.0 + light_time_s));
    CHECK(missed == std::vector<std::string>{"pyros_armed_vent", "coolant_vent", "pyros_safe_vent", "uhf_start",
                                             "x_band_tones", "entry_antenna"});
    CHECK(deadlines.missed(before_entry(2000.0), before_entry(2000.0)).empty());
}

TEST_CASE("where nobody predicts entry nothing is too late", "[gateway][R44]") {
    const PlannedDeadlines deadlines{tests::shipped_dictionary(), {}, light_time_s};
    CHECK_FALSE(deadlines.next(before_entry(3000.0)));
    CHECK(deadlines.missed(before_entry(3000.0), before_entry(0.0)).empty());
}

TEST_CASE("a deadline is that of the plan as flight has changed it by command", "[gateway][R19][R44]") {
    const auto& words = tests::shipped_dictionary();
    PlannedDeadlines deadlines{words, entry, light_time_s};
    const auto& change = *words.command("EDL_SET_TIMEPOINT_OFFSET");
    const auto row = row_of("coolant_vent");
    const auto& planned = words.timeline[row];
    REQUIRE(planned.desired_offset_s);
    const std::vector<commands::NamedValue> later{{"timepoint", static_cast<double>(row)},
                                                  {"desired_offset_s", *planned.desired_offset_s + 5.0},
                                                  {"minimum_offset_s", planned.minimum_offset_s.value_or(0.0)}};
    const auto before = deadlines.of(change, later, before_entry(3000.0));
    REQUIRE(before);
    deadlines.executed(*words.command("NO_OP"), {});
    CHECK(deadlines.of(change, later, before_entry(3000.0)) == before);
    deadlines.executed(change, later);
    const auto after = deadlines.of(change, later, before_entry(3000.0));
    REQUIRE(after);
    CHECK(after->timepoint == "coolant_vent");
    CHECK(after->latest.microseconds - before->latest.microseconds == 5'000'000);
}

}  // namespace commands_planned_deadlines_test
