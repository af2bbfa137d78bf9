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

/// A small landing. Clock and entry: SCLK 1000 is entry.
struct SmallTimeline {
    dictionary::Dictionary dictionary;
    dictionary::TimelineKnowledge known;

    SmallTimeline() {
        const auto anchor = [&](const char* name, std::optional<std::uint16_t> parent, MaybeOffset design_e_s) {
            const AnchorId id{static_cast<std::uint16_t>(dictionary.anchors.size())};
            dictionary.anchors.push_back({id, name, parent ? std::optional{AnchorId{*parent}} : std::nullopt, {}, ""});
            known.design_e_s.push_back(design_e_s);
        };
        anchor("root", {}, {});
        anchor("entry", 0, 0.0);
        anchor("parachute", 0, 250.0);
        anchor("heatshield", 1, 270.0);
        anchor("nobody_knows", 0, {});
        const auto row = [&](const char* name, std::optional<std::uint16_t> of, MaybeOffset desired_s,
                             MaybeOffset minimum_s) {
            dictionary::TimelineRow added;
            added.id = TimepointId{static_cast<std::uint16_t>(dictionary.timeline.size())};
            added.name = name;
            if (of) added.anchor = AnchorId{*of};
            added.desired_offset_s = desired_s;
            added.minimum_offset_s = minimum_s;
            dictionary.timeline.push_back(added);
        };
        row("vent", 1, -50.0, 0.0);
        row("interface", 1, 0.0, 0.0);
        row("mortar", 2, 0.0, 0.0);
        row("radar", 2, 6.0, 0.0);
        row("shield", 3, 0.0, 20.0);
        row("beams", {}, 2.0, 2.0);
        row("unknown", 4, 0.0, 0.0);
        known.clock_zero_e_s = -1000.0;
        known.heard.resize(dictionary.timeline.size());
        known.reports.resize(dictionary.anchors.size());
    }
    void fires(const char* name, double triggered_e_s, double fired_e_s) {
        known.heard[row_of(dictionary, name)] = {triggered_e_s, fired_e_s};
    }
    void change_timepoint(const char* name, double desired_s, double since_e_s) {
        const TimepointId id{static_cast<std::uint16_t>(row_of(dictionary, name))};
        known.changes.push_back({dictionary::OffsetChange::OfTimepoint{id, desired_s, 0.0}, since_e_s});
    }
    void change_anchor(std::uint16_t id, double offset_s, double since_e_s) {
        known.changes.push_back({dictionary::OffsetChange::OfAnchor{AnchorId{id}, offset_s}, since_e_s});
    }
    MaybeOffset of(const char* name) const {
        return predict(dictionary, known).timepoints[row_of(dictionary, name)].e_s;
    }
    Heard all() const {
        Heard times;
        for (const auto& timepoint : predict(dictionary, known).timepoints) times.push_back(timepoint.e_s);
        return times;
    }
    dictionary::TimelinePrediction::Anchor anchor(std::size_t id) const {
        return predict(dictionary, known).anchors[id];
    }
};

using Basis = dictionary::TimelinePrediction::Anchor::Basis;
using Unknown = dictionary::TimelinePrediction::Timepoint::Unknown;

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
    const auto armed = row_of(dictionary, "pyros_armed_vent"), vent = row_of(dictionary, "coolant_vent");
    heard[armed] = -828.0 + 5.25;  // it waited for a reply: later than its anchor says
    heard[vent] = -826.0 + 5.0;
    const auto predicted = predicted_from_entry_s(dictionary, dictionary.predicted_anchor_e_s, heard);
    CHECK(predicted[armed] == -828.0);
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

TEST_CASE("the prediction is the rule over predicted anchors, minimum offsets included", "[timeline][R11]") {
    const SmallTimeline t;
    CHECK(t.all() == Heard{-50.0, 0.0, 250.0, 256.0, 276.0, 278.0, {}});
    CHECK(predict(t.dictionary, t.known).timepoints[6].unknown == Unknown::anchor);
}

TEST_CASE("an anchor that was heard of moves all that comes after it, but not what had fired", "[timeline]") {
    SmallTimeline t;
    t.known.now_e_s = 243.0;
    t.fires("mortar", 240.0, 241.0);
    CHECK(t.of("mortar") == 250.0);
    CHECK(t.of("radar") == 246.0);  // by the triggering: the reply of the mortar took a second
    CHECK(t.of("shield") == 266.0);
    CHECK(t.anchor(2).basis == Basis::firing);
    CHECK(t.anchor(2).firing == TimepointId{2});
    CHECK(t.anchor(2).defined);
}

TEST_CASE("an anchor that is overdue comes now at the earliest, and moves those after it along", "[timeline]") {
    SmallTimeline t;
    t.known.now_e_s = 280.0;
    CHECK(t.of("interface") == 0.0);  // the clock's, not the vehicle's
    CHECK(t.of("mortar") == 280.0);
    CHECK(t.of("radar") == 286.0);
    CHECK(t.of("shield") == 306.0);
    CHECK(t.anchor(2).basis == Basis::overdue);
    CHECK_FALSE(t.anchor(2).defined);
}

TEST_CASE("an anchor that must have come before what was heard of is not overdue", "[timeline]") {
    SmallTimeline t;
    t.known.now_e_s = 300.0;
    t.fires("shield", 262.0, 262.0);  // of the mortar nothing was heard
    CHECK(t.of("mortar") == 250.0);
    CHECK(t.of("radar") == 256.0);
    t.fires("shield", 245.0, 245.0);
    CHECK(t.of("mortar") == 245.0);
    CHECK(t.of("radar") == 245.0);
    CHECK(t.of("beams") == 247.0);
}

TEST_CASE("a changed offset counts for its timepoint unless that had fired before", "[timeline][R16]") {
    SmallTimeline t;
    t.change_timepoint("radar", 9.0, -90.0);
    CHECK(t.of("radar") == 259.0);
    t.fires("mortar", 250.0, 250.0);
    t.fires("radar", 259.0, 259.0);
    CHECK(t.anchor(2).e_s == 250.0);  // the earliest: both say it
    t.change_timepoint("radar", 100.0, 300.0);
    CHECK(t.of("radar") == 259.0);
}

TEST_CASE("a changed offset moves what it holds back, and nothing else", "[timeline]") {
    SmallTimeline t;
    t.change_timepoint("radar", 16.0, -90.0);
    CHECK(t.all() == Heard{-50.0, 0.0, 250.0, 266.0, 286.0, 288.0, {}});
}

TEST_CASE("another time of entry moves all", "[timeline][R16]") {
    SmallTimeline t;
    t.change_anchor(1, 1005.0, -90.0);  // from the clock's zero
    CHECK(t.all() == Heard{-45.0, 5.0, 255.0, 261.0, 281.0, 283.0, {}});
    CHECK(t.anchor(1).basis == Basis::command);
    CHECK(t.anchor(1).offset_s == 1005.0);
}

TEST_CASE("a changed anchor counts from its parent, and until flight itself finds the anchor", "[timeline][R16][R17]") {
    SmallTimeline t;
    t.change_anchor(3, 300.0, -90.0);
    CHECK(t.of("shield") == 300.0);
    t.change_anchor(2, 1260.0, -90.0);
    CHECK(t.of("mortar") == 260.0);
    CHECK(t.of("radar") == 266.0);
    t.fires("mortar", 240.0, 241.0);
    CHECK(t.of("radar") == 246.0);
    t.change_anchor(2, 1300.0, 245.0);  // after it had fired: what is yet to come follows it
    CHECK(t.of("radar") == 306.0);
}

TEST_CASE("flight's own report of an anchor counts before what firings tell, until a later change", "[timeline]") {
    SmallTimeline t;
    t.fires("mortar", 240.0, 241.0);
    t.known.reports[2] = {.anchor_e_s = 239.5, .at_e_s = 242.0};
    CHECK(t.of("radar") == 245.5);
    CHECK(t.anchor(2).basis == Basis::report);
    t.change_anchor(2, 1300.0, 243.0);
    CHECK(t.of("radar") == 306.0);
}

TEST_CASE("without the zero of the clock a change of an anchor on it says nothing", "[timeline]") {
    SmallTimeline t;
    t.known.clock_zero_e_s.reset();
    t.change_anchor(2, 1260.0, -90.0);
    CHECK(t.of("mortar") == 250.0);
}

TEST_CASE("what is not predicted says why", "[timeline][R13]") {
    SmallTimeline t;
    const auto why = [&](const char* name) {
        return predict(t.dictionary, t.known).timepoints[row_of(t.dictionary, name)].unknown;
    };
    CHECK(why("mortar") == Unknown::nothing);
    t.dictionary.timeline[4].minimum_offset_s.reset();  // the shield
    CHECK(why("shield") == Unknown::offset);
    CHECK(why("beams") == Unknown::previous);
    t.dictionary.timeline[0].anchor.reset();
    CHECK(why("vent") == Unknown::previous);  // "do edl"
}

TEST_CASE("the landing can begin until the first timepoint on an anchor, less what those before it may take",
          "[timeline][R23]") {
    const auto& dictionary = tests::shipped_dictionary();
    CHECK(predict(dictionary, {}).latest_begin_e_s == -828.0 - 12.0);  // 2 + 4 + 2 + 4
    SmallTimeline t;
    CHECK(predict(t.dictionary, t.known).latest_begin_e_s == -50.0);
    t.change_anchor(1, 1005.0, -90.0);
    CHECK(predict(t.dictionary, t.known).latest_begin_e_s == -45.0);
    for (auto& row : t.dictionary.timeline) row.anchor.reset();
    CHECK_FALSE(predict(t.dictionary, t.known).latest_begin_e_s);
}

TEST_CASE("a timepoint that may be late does not bound do edl, and then follows it at once", "[timeline][R23]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto heaters = row_of(dictionary, "catbed_heaters");
    REQUIRE(dictionary.timeline[heaters].may_be_late);
    dictionary::TimelineKnowledge known;
    const auto predicted = [&] { return predict(dictionary, known).timepoints[heaters]; };
    CHECK(predicted().e_s == -10800.0);
    known.now_e_s = -1180.0;
    CHECK_FALSE(predicted().e_s);
    CHECK(predicted().unknown == Unknown::previous);
    known.heard = {dictionary::TimelineKnowledge::Firing{-1168.0, -1167.5}};
    CHECK(predicted().e_s == -1165.5);  // 2 s after the first
    known.heard = {dictionary::TimelineKnowledge::Firing{-518'400.0, -518'399.5}};
    CHECK(predicted().e_s == -10800.0);
}

TEST_CASE("at most five are predicted in one cycle", "[timeline][R15]") {
    SmallTimeline t;
    t.dictionary.timeline.resize(1);
    for (std::uint16_t i = 1; i < 12; ++i) {
        auto row = t.dictionary.timeline.front();
        row.id = TimepointId{i};
        t.dictionary.timeline.push_back(row);
    }
    const auto times = planned_from_entry_s(t.dictionary);
    CHECK(times[4] == -50.0);
    CHECK(times[5] == -50.0 + seconds_per_tick);
    CHECK(times[9] == -50.0 + seconds_per_tick);
    CHECK(times[10] == -50.0 + 2 * seconds_per_tick);
}

}  // namespace dictionaries_timeline_plan_test
