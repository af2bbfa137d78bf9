// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_plan.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace dictionaries_timeline_plan_test {

using namespace aeolis;

namespace {

using Heard = std::vector<std::optional<double>>;

std::size_t row_of(const dictionary::Dictionary& dictionary, const std::string& name) {
    const auto row = std::ranges::find(dictionary.timeline, name, &dictionary::TimelineRow::name);
    REQUIRE(row != dictionary.timeline.end());
    return static_cast<std::size_t>(row - dictionary.timeline.begin());
}

}  // namespace

TEST_CASE("what the plan alone gives is predicted as planned, while nothing was heard", "[timeline]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto planned = planned_from_entry_s(dictionary);
    const auto predicted = predicted_from_entry_s(dictionary, dictionary.predicted_anchor_e_s, Heard(planned.size()));
    for (std::size_t i = 0; i < planned.size(); ++i) {
        INFO(dictionary.timeline[i].name);
        if (planned[i]) CHECK(predicted[i] == planned[i]);
    }
}

TEST_CASE("after entry a timepoint is predicted by its anchor in the design, and by the minimum offsets before it",
          "[timeline]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto predicted =
        predicted_from_entry_s(dictionary, dictionary.predicted_anchor_e_s, Heard(dictionary.timeline.size()));
    const auto of = [&](const char* name) { return predicted[row_of(dictionary, name)].value_or(0.0); };
    CHECK(of("entry_guidance") == 43.0);
    CHECK(of("parachute_deploy") == 255.9);
    CHECK(of("radar_power") == 255.9 + 6.0);
    CHECK(of("balance_2") == 241.0);
    CHECK(of("heatshield_separation") == 277.35);
    const auto planned = planned_from_entry_s(dictionary);
    CHECK_FALSE(planned[row_of(dictionary, "parachute_deploy")].has_value());  // the plan alone cannot say
}

TEST_CASE("an entry that was heard of as later moves all that comes after it, and not the prediction of what had fired",
          "[timeline]") {
    const auto& dictionary = tests::shipped_dictionary();
    Heard heard(dictionary.timeline.size());
    const auto vent = row_of(dictionary, "coolant_vent"), uhf = row_of(dictionary, "uhf_start");
    heard[vent] = -826.0 + 5.25;  // it waited for a reply: later than its anchor says
    heard[uhf] = -800.0 + 5.0;
    const auto predicted = predicted_from_entry_s(dictionary, dictionary.predicted_anchor_e_s, heard);
    CHECK(predicted[vent] == -826.0);
    CHECK(predicted[row_of(dictionary, "entry_interface")] == 5.0);  // by the earliest of the two
    CHECK(predicted[row_of(dictionary, "parachute_deploy")] == Approx(260.9));
}

TEST_CASE("a timepoint whose anchor nobody predicts has no prediction", "[timeline]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto predicted = predicted_from_entry_s(dictionary, {}, Heard(dictionary.timeline.size()));
    CHECK(predicted[row_of(dictionary, "entry_interface")] == 0.0);
    CHECK_FALSE(predicted[row_of(dictionary, "parachute_deploy")].has_value());
}

TEST_CASE("it is the design that is given which predicts, not the one of the dictionary", "[timeline]") {
    const auto& dictionary = tests::shipped_dictionary();
    auto design_e_s = dictionary.predicted_anchor_e_s;
    const auto parachute = dictionary.timeline[row_of(dictionary, "parachute_deploy")].anchor;
    REQUIRE(parachute.has_value());
    design_e_s[parachute->value] = 260.0;
    const auto predicted = predicted_from_entry_s(dictionary, design_e_s, Heard(dictionary.timeline.size()));
    CHECK(predicted[row_of(dictionary, "parachute_deploy")] == 260.0);
}

}  // namespace dictionaries_timeline_plan_test
