// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_diff.hpp"

#include "dictionaries/spreadsheet/csv.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

#include <algorithm>

namespace dictionaries_timeline_diff_test {

using namespace aeolis;
using namespace aeolis::dictionary;

namespace {

Dictionary loaded(const tests::MissionCopy& mission) {
    const Loaded result = mission.load();
    INFO(tests::lines_of(result));
    REQUIRE(result.dictionary);
    return *result.dictionary;
}

void replace(const tests::MissionCopy& mission, const std::string& file, std::string_view find,
             std::string_view replacement) {
    std::string text = mission.text(file);
    const auto position = text.find(find);
    REQUIRE(position != std::string::npos);
    mission.write(file, text.replace(position, find.size(), replacement));
}

std::string line_of(const std::string& text, std::string_view begins) {
    const auto begin = text.find("\n" + std::string{begins});
    REQUIRE(begin != std::string::npos);
    return text.substr(begin + 1, text.find('\n', begin + 1) - begin);
}

const RowChange& change_of(const SheetDiff& sheet, std::string_view name) {
    const auto found = std::ranges::find(sheet.rows, name, &RowChange::name);
    REQUIRE(found != sheet.rows.end());
    return *found;
}

/// The sheet written again, with another choice of quotes, line ends and mark in front, as programs differ in them.
std::string saved(const std::string& text, bool quote_all, bool carriage_returns, bool byte_order_mark) {
    std::vector<Finding> all;
    Findings findings{"", all};
    const auto sheet = read_csv(text, findings);
    REQUIRE(sheet);
    std::string out = byte_order_mark ? "\xEF\xBB\xBF" : "";
    const auto write = [&](const std::vector<std::string>& cells) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (i > 0) out += ',';
            const bool quoted = quote_all || cells[i].find_first_of(",\"\n") != std::string::npos;
            if (quoted) out += '"';
            for (const char c : cells[i]) out += c == '"' && quoted ? std::string{"\"\""} : std::string{c};
            if (quoted) out += '"';
        }
        out += carriage_returns ? "\r\n" : "\n";
    };
    write(sheet->header.cells);
    for (const auto& row : sheet->rows) write(row.cells);
    return out;
}

}  // namespace

TEST_CASE("a version does not differ from itself", "[timeline][R20]") {
    const tests::MissionCopy mission;
    const Dictionary d = loaded(mission);
    const TimelineDiff diff = compare_timelines(d, d);
    CHECK(diff.same());
    CHECK(diff.version_before == diff.version_after);
}

TEST_CASE("two versions are compared row by row: added, removed, moved, and each changed cell", "[timeline][R20]") {
    const tests::MissionCopy before;
    const tests::MissionCopy after;
    std::string text = before.text("timeline.csv");
    const std::string moved = line_of(text, "radar_off,");
    const std::string removed = line_of(text, "bogie_release,");
    text.erase(text.find(moved), moved.size());
    text.erase(text.find(removed), removed.size());
    text.insert(text.find(line_of(text, "recording_close,")), moved);
    text.insert(text.find(line_of(text, "recording_close,")), "quiet,previous,1,0,,undefined,,,,no,no,,,New\n");
    after.write("timeline.csv", text);
    replace(after, "timeline.csv", "gnc_enable,entry,-540,0,", "gnc_enable,entry,-539,undefined,");
    replace(after, "anchors.csv", "-14400", "-14401");
    replace(after, "constraints.csv", "coolant_vent,uhf_start,20,", "coolant_vent,uhf_start,21,");

    const Dictionary a = loaded(before);
    const Dictionary b = loaded(after);
    const TimelineDiff diff = compare_timelines(a, b);
    CHECK_FALSE(diff.same());
    CHECK(diff.version_before == a.timeline_version);
    CHECK(diff.version_after == b.timeline_version);
    CHECK(diff.version_before != diff.version_after);

    REQUIRE(diff.sheets.size() == 3);
    const SheetDiff& timeline = diff.sheets[0];
    CHECK(timeline.file == "timeline.csv");
    CHECK(timeline.rows.size() == 4);
    CHECK(change_of(timeline, "bogie_release").before == 49);
    CHECK_FALSE(change_of(timeline, "bogie_release").after);
    CHECK_FALSE(change_of(timeline, "quiet").before);
    REQUIRE(change_of(timeline, "quiet").after);
    CHECK(*change_of(timeline, "quiet").after == 56);
    CHECK(change_of(timeline, "radar_off").moved);
    CHECK(change_of(timeline, "radar_off").cells.empty());
    const RowChange& changed = change_of(timeline, "gnc_enable");
    CHECK_FALSE(changed.moved);
    REQUIRE(changed.cells.size() == 2);
    CHECK(changed.cells[0].column == "desired_offset_s");
    CHECK(changed.cells[0].before == "-540");
    CHECK(changed.cells[0].after == "-539");
    CHECK(changed.cells[1].column == "minimum_offset_s");
    CHECK(changed.cells[1].after == "undefined");

    REQUIRE(diff.sheets[1].rows.size() == 1);
    CHECK(diff.sheets[1].rows[0].name == "pre_edl_end");
    REQUIRE(diff.sheets[2].rows.size() == 1);
    CHECK(diff.sheets[2].rows[0].name == "required coolant_vent:fired -> uhf_start:triggered");
}

TEST_CASE("the comparison the other way round swaps added and removed", "[timeline][R20]") {
    const tests::MissionCopy before;
    const tests::MissionCopy after;
    std::string text = before.text("timeline.csv");
    const std::string removed = line_of(text, "bogie_release,");
    after.write("timeline.csv", text.erase(text.find(removed), removed.size()));
    const auto forward = compare_timelines(loaded(before), loaded(after));
    const auto back = compare_timelines(loaded(after), loaded(before));
    REQUIRE(forward.sheets[0].rows.size() == 1);
    REQUIRE(back.sheets[0].rows.size() == 1);
    CHECK(forward.sheets[0].rows[0].before == back.sheets[0].rows[0].after);
}

TEST_CASE("sheets written again with other quotes, other line ends and a mark in front are the same timeline",
          "[timeline][R20]") {
    const tests::MissionCopy before;
    const Dictionary original = loaded(before);
    for (const bool quote_all : {false, true})
        for (const bool carriage_returns : {false, true})
            for (const bool byte_order_mark : {false, true}) {
                INFO(quote_all << carriage_returns << byte_order_mark);
                const tests::MissionCopy after;
                for (const char* file :
                     {"timeline.csv", "anchors.csv", "constraints.csv", "tones.csv", "parameters.csv"})
                    after.write(file, saved(after.text(file), quote_all, carriage_returns, byte_order_mark));
                CHECK(compare_timelines(original, loaded(after)).same());
            }
}

TEST_CASE("the shipped sheets quote only the cells that need it, and end lines with one octet", "[timeline][R20]") {
    const tests::MissionCopy mission;
    for (const char* file : {"timeline.csv", "anchors.csv", "constraints.csv"}) {
        INFO(file);
        CHECK(saved(mission.text(file), false, false, false) == mission.text(file));
    }
}

}  // namespace dictionaries_timeline_diff_test
