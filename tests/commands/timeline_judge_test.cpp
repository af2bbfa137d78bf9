// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_judge.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace commands_timeline_judge_test {

using namespace aeolis;
using namespace aeolis::commands;
using Why = timeline::Unsafe::Why;

namespace {

constexpr Sclk entry{397501715.0};

TimepointId row(const char* name) {
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto found = std::ranges::find(timeline, name, &dictionary::TimelineRow::name);
    REQUIRE(found != timeline.end());
    return found->id;
}
AnchorId anchor(const char* name) {
    const auto& anchors = tests::shipped_dictionary().anchors;
    const auto found = std::ranges::find(anchors, name, &dictionary::AnchorRow::name);
    REQUIRE(found != anchors.end());
    return found->id;
}

/// A packet as it was decoded: these values, and nothing else.
dictionary::Decoded packet(const char* name, Sclk time, std::initializer_list<std::pair<const char*, double>> values) {
    const auto& words = tests::shipped_dictionary();
    const auto* known = words.packet(name);
    REQUIRE(known != nullptr);
    dictionary::Decoded decoded;
    decoded.packet = static_cast<std::size_t>(known - words.packets.data());
    decoded.header.time = time;
    decoded.value.resize(known->fields.size());
    for (const auto& [field, value] : values) {
        const auto index = field_index(*known, field);
        REQUIRE(index);
        decoded.value[*index] = value;
    }
    return decoded;
}

struct Ground {
    TimelineJudge judge{tests::shipped_dictionary()};

    /// The vehicle is at this timepoint, and the one before has fired then.
    void hear_status(double e_s, const char* current, double previous_fired_e_s) {
        const TimepointId id = row(current);
        const double minimum_s = *tests::shipped_dictionary().timeline[id.value].minimum_offset_s;
        judge.hear(packet("TimelineStatus", entry + e_s,
                          {{"timepoint_index", id.value},
                           {"timepoint_state", 0.0},
                           {"next_minimum_sclk", (entry + (previous_fired_e_s + minimum_s)).seconds},
                           {"entry_anchor_sclk", entry.seconds}}));
    }
    void hear_firing(const char* timepoint, double triggered_e_s, double fired_e_s) {
        judge.hear(packet("TimepointFired", entry + fired_e_s,
                          {{"timepoint", row(timepoint).value},
                           {"triggered_sclk", (entry + triggered_e_s).seconds},
                           {"fired_sclk", (entry + fired_e_s).seconds}}));
    }
    std::optional<Why> why(const timeline::Change& change, std::optional<double> arrives_e_s) const {
        const auto unsafe =
            judge.judge(change, entry, arrives_e_s ? std::optional{entry + *arrives_e_s} : std::nullopt);
        return unsafe ? std::optional{unsafe->why} : std::nullopt;
    }
};

timeline::TimepointChange change(const char* timepoint, double desired_s) {
    const TimepointId id = row(timepoint);
    return {id, desired_s, tests::shipped_dictionary().timeline[id.value].minimum_offset_s};
}
timeline::AnchorChange entry_moved(double by_s) {
    return {anchor("entry"), (entry + by_s).seconds};
}

}  // namespace

TEST_CASE("ground moves entry no farther than from where its own navigation has it, whatever time it is",
          "[commands][timeline][R51]") {
    const Ground ground;
    for (const auto arrives_e_s : {std::optional<double>{}, std::optional{-1000.0}}) {
        CHECK(ground.why(entry_moved(300.0), arrives_e_s) == Why::not_navigated);
        CHECK(ground.why(entry_moved(-900.0), arrives_e_s) == Why::not_navigated);
        CHECK_FALSE(ground.why(entry_moved(5.0), arrives_e_s));
    }
    CHECK(ground.why(timeline::AnchorChange{anchor("touchdown"), entry.seconds}, {}) == Why::decided_in_flight);
}

TEST_CASE("ground judges by what has fired, as it was heard", "[commands][timeline][R51]") {
    Ground ground;
    CHECK_FALSE(ground.why(change("coolant_vent", -825.0), -1000.0));
    ground.hear_firing("coolant_vent", -826.0, -822.0);
    CHECK(ground.why(change("coolant_vent", -810.0), -818.0) == Why::triggered_already);
    CHECK(ground.why(change("uhf_start", -810.0), -818.0) == Why::too_soon);  // 12 s after the vent, not the 20 s
    CHECK_FALSE(ground.why(change("uhf_start", -801.0), -818.0));
}

TEST_CASE("what fires by the plan before the command arrives counts as fired", "[commands][timeline][R51]") {
    Ground ground;
    ground.hear_status(-1500.0, "coolant_vent", -1700.0);
    CHECK_FALSE(ground.why(change("uhf_start", -801.0), -900.0));
    CHECK(ground.why(change("uhf_start", -801.0), -672.0) == Why::triggered_already);
    CHECK(ground.why(change("cruise_stage_separation", -99.953125), -672.0) == Why::overdue);
    CHECK_FALSE(ground.why(change("cruise_stage_separation", 1.046875), -672.0));
}

TEST_CASE("a timepoint whose reply is due has been triggered", "[commands][timeline][R51]") {
    Ground ground;
    const auto id = row("coolant_vent");
    ground.judge.hear(packet("TimelineStatus", entry - 825.0,
                             {{"timepoint_index", id.value},
                              {"timepoint_state", 2.0},
                              {"entry_anchor_sclk", entry.seconds},
                              {"next_minimum_sclk", (entry - 1160.0).seconds}}));
    CHECK(ground.why(change("coolant_vent", -810.0), -825.0) == Why::triggered_already);
}

TEST_CASE("a change that was made, or is on its way, is what the next is judged with", "[commands][timeline][R51]") {
    Ground ground;
    ground.hear_status(-1000.0, "coolant_vent", -1160.0);
    CHECK(ground.why(change("cruise_stage_separation", 6.046875), -990.0) == Why::too_soon);  // the detumble's plumes
    ground.judge.make(change("detumble", -516.0));
    CHECK_FALSE(ground.why(change("cruise_stage_separation", 6.046875), -990.0));
}

TEST_CASE("do edl comes too late when its first timepoint on the clock would be overdue, less the margin",
          "[commands][R23][R51]") {
    const Ground ground;
    const auto& given = tests::shipped_dictionary().constraints;
    const auto row = std::ranges::find_if(given, [](const auto& each) {
        return each.from == timeline::Moment::of_do_edl() && each.to == timeline::Moment::of_anchor(anchor("entry"));
    });
    REQUIRE(row != given.end());
    const double latest_e_s = -*row->minimum_s;  // by the margin and what comes before that timepoint
    const auto late_s = [&](double e_s) { return ground.judge.begins_late_s(entry, entry + e_s); };
    CHECK_FALSE(late_s(latest_e_s - seconds_per_tick));
    CHECK(late_s(latest_e_s) == 0.0);
    CHECK(late_s(latest_e_s + 44.0) == 44.0);
    CHECK_FALSE(ground.judge.begins_late_s({}, entry));  // nobody knows when entry is
}

TEST_CASE("why a change is unsafe is said by name, with seconds and the row of constraints.csv", "[commands][R51]") {
    Ground ground;
    ground.hear_firing("coolant_vent", -826.0, -822.0);
    const auto said = [&](const timeline::Change& asked) {
        const auto unsafe = ground.judge.judge(asked, entry, entry - 818.0);
        REQUIRE(unsafe);
        return ground.judge.text(*unsafe);
    };
    CHECK(said(entry_moved(300.0)) == "entry would be 300.000 s later than ground's navigation solution has it");
    CHECK(said(change("uhf_start", -819.0)) ==
          "uhf_start would be overdue by 1.000 s when the command arrives, and fire at once");
    CHECK_THAT(said(change("uhf_start", -810.0)),
               Catch::StartsWith("uhf_start would come 8.000 s too soon after coolant_vent:fired (constraints.csv:"));
    CHECK(said(timeline::AnchorChange{anchor("touchdown"), 0.0}) ==
          "the anchor touchdown is decided in flight: no command moves it");
    CHECK(said(change("coolant_vent", -810.0)) == "coolant_vent will have been triggered when the command arrives");
}

}  // namespace commands_timeline_judge_test
