// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace commands_timeline_change_test {

using namespace aeolis;

TEST_CASE("a command that changes an offset changes that row of the timeline alone", "[commands][R19]") {
    auto changed = tests::shipped_dictionary();
    const std::vector<commands::NamedValue> timepoint{
        {"timepoint", 3.0}, {"desired_offset_s", -820.0}, {"minimum_offset_s", 1.0}};
    CHECK(commands::changes_offsets("EDL_SET_TIMEPOINT_OFFSET"));
    commands::apply_offsets(changed, "EDL_SET_TIMEPOINT_OFFSET", timepoint);
    CHECK(changed.timeline[3].desired_offset_s == -820.0);
    CHECK(changed.timeline[3].minimum_offset_s == 1.0);
    CHECK(changed.timeline[4].desired_offset_s == tests::shipped_dictionary().timeline[4].desired_offset_s);

    const std::vector<commands::NamedValue> anchor{{"anchor", 2.0}, {"offset_s", -7200.0}};
    commands::apply_offsets(changed, "EDL_SET_ANCHOR_OFFSET", anchor);
    CHECK(changed.anchors[2].offset_s == -7200.0);
}

TEST_CASE("what a command moves is the timepoint that it names, or all that hang on the anchor that it names",
          "[commands][R19]") {
    const auto& words = tests::shipped_dictionary();
    CHECK(commands::moved_timepoints(words, "EDL_SET_TIMEPOINT_OFFSET",
                                     std::vector<commands::NamedValue>{{"timepoint", 3.0}}) ==
          std::vector<std::size_t>{3});
    const auto& anchor = words.timeline[3].anchor;
    REQUIRE(anchor);
    const auto moved =
        commands::moved_timepoints(words, "EDL_SET_ANCHOR_OFFSET",
                                   std::vector<commands::NamedValue>{{"anchor", static_cast<double>(anchor->value)}});
    REQUIRE(moved.size() > 1);
    for (const auto index : moved) CHECK(words.timeline[index].anchor == anchor);
    CHECK(commands::moved_timepoints(words, "NO_OP",
                                     std::vector<commands::NamedValue>{{"timepoint", 3.0}, {"anchor", 0.0}})
              .empty());
}

TEST_CASE("a row that is not there, and any other command, change nothing", "[commands][R19]") {
    auto changed = tests::shipped_dictionary();
    const auto before = changed.timeline[0].desired_offset_s;
    const std::vector<commands::NamedValue> beyond{{"timepoint", 1.0e6}, {"anchor", 1.0e6}, {"desired_offset_s", 5.0}};
    for (const char* command : {"EDL_SET_TIMEPOINT_OFFSET", "EDL_SET_ANCHOR_OFFSET", "NO_OP"})
        commands::apply_offsets(changed, command, beyond);
    commands::apply_offsets(changed, "NO_OP",
                            std::vector<commands::NamedValue>{{"timepoint", 0.0}, {"desired_offset_s", 5.0}});
    CHECK(changed.timeline[0].desired_offset_s == before);
    CHECK_FALSE(commands::changes_offsets("EDL_SET_PARAMETERS"));
}

TEST_CASE("a change of offsets is of the timepoint or anchor that the command names; of parameters, of entry",
          "[commands][timeline][R16]") {
    using dictionary::OffsetChange;
    const auto& words = tests::shipped_dictionary();
    const auto change = [&](const char* command, const std::vector<commands::NamedValue>& arguments) {
        return commands::offset_change(words, command, arguments);
    };
    const auto timepoint = change("EDL_SET_TIMEPOINT_OFFSET",
                                  {{"timepoint", 3.0}, {"desired_offset_s", -820.0}, {"minimum_offset_s", 1.0}});
    REQUIRE(timepoint);
    const auto& of_timepoint = std::get<OffsetChange::OfTimepoint>(timepoint->what);
    CHECK(of_timepoint.id == TimepointId{3});
    CHECK(of_timepoint.desired_s == -820.0);
    CHECK(of_timepoint.minimum_s == 1.0);
    const auto anchor = change("EDL_SET_ANCHOR_OFFSET", {{"anchor", 2.0}, {"offset_s", -7200.0}});
    REQUIRE(anchor);
    CHECK(std::get<OffsetChange::OfAnchor>(anchor->what).id == AnchorId{2});
    CHECK(std::get<OffsetChange::OfAnchor>(anchor->what).offset_s == -7200.0);
    const auto entry = change("EDL_SET_PARAMETERS", {{"entry_sclk", 397501714.0}});
    REQUIRE(entry);
    const auto& of_entry = std::get<OffsetChange::OfAnchor>(entry->what);
    CHECK(words.anchors[of_entry.id.value].name == "entry");
    CHECK(of_entry.offset_s == 397501714.0);

    CHECK_FALSE(change("EDL_SET_TIMEPOINT_OFFSET", {{"timepoint", 3.0}}));
    CHECK_FALSE(change("EDL_SET_TIMEPOINT_OFFSET",
                       {{"timepoint", 1.0e6}, {"desired_offset_s", 1.0}, {"minimum_offset_s", 1.0}}));
    CHECK_FALSE(change("EDL_SET_ANCHOR_OFFSET", {{"anchor", 0.0}, {"offset_s", 5.0}}));  // the root stands still
    CHECK_FALSE(change("EDL_SET_ANCHOR_OFFSET", {{"anchor", 1.0e6}, {"offset_s", 5.0}}));
    CHECK_FALSE(change("NO_OP", {}));
}

}  // namespace commands_timeline_change_test
