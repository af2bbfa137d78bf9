// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/tables.hpp"
#include "tests/support/planted.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace dictionaries_ground_sheets_test {

using namespace aeolis;
using aeolis::tests::Planted;

TEST_CASE("each broken rule of the clock's table and of the predicted anchors gives one line, and nothing is loaded",
          "[dictionary][time]") {
    static const std::vector<Planted> all{
        {"no time", "clock_correlation.csv", "2012-219T05:10:47.400", "2012-08-06 05:10:47",
         "scet: '2012-08-06 05:10:47' is not a time like 2012-219T05:10:47.400"},
        {"no clock drifts so", "clock_correlation.csv", ".400,0,35", ".400,0.001,35", "drift: is more than 1e-4"},
        {"no leap seconds", "clock_correlation.csv", ".400,0,35", ".400,0,", "leap_seconds '' is not a whole number"},
        {"no version", "clock_correlation.csv", "1,0,397501715,", "0,0,397501715,",
         "version '0' is not a whole number"},
        {"unknown anchor", "predicted_anchors.csv", "touchdown,431.47", "touchup,431.47",
         "anchor 'touchup': there is no such anchor in anchors.csv"},
        {"anchor twice", "predicted_anchors.csv", "touchdown,431.47", "backshell,431.47",
         "anchor 'backshell': is there twice"},
        {"no number", "predicted_anchors.csv", "touchdown,431.47", "touchdown,soon",
         "after_entry_s 'soon' is not a number"},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("rows of the clock's table follow one another: by version, by time, and in SCET but for leap seconds",
          "[dictionary][time]") {
    const auto findings_of = [](const char* second) {
        std::vector<dictionary::Finding> all;
        dictionary::Findings findings{"clock_correlation.csv", all};
        const auto rows = dictionary::read_clock_correlation(
            std::string{
                "version,valid_from_sclk,sclk,scet,drift,leap_seconds,note\n1,0,1000,2012-182T00:00:00,0,34,\n"} +
                second + "\n",
            findings);
        REQUIRE(rows);
        CHECK(rows->size() == 2);
        return all.empty() ? std::string{} : all.front().text();
    };
    CHECK(findings_of("2,2000,2000,2012-182T00:16:40.2,1e-6,34,").empty());
    CHECK(findings_of("2,2000,2000,2012-182T00:16:39,0,35,").empty());  // a leap second went by
    CHECK_THAT(
        findings_of("2,2000,2000,2012-182T00:16:39,0,34,"),
        Catch::Contains("clock_correlation.csv:3: version '2': scet: by the row before it was 2012-182T00:16:40.000"));
    CHECK_THAT(findings_of("2,0,2000,2012-182T00:16:40,0,34,"), Catch::Contains("valid_from_sclk: is not after"));
    CHECK_THAT(findings_of("1,2000,2000,2012-182T00:16:40,0,34,"), Catch::Contains("version: is not above"));
}

TEST_CASE("the clock of the landing is the row that holds then, and none before the first", "[dictionary][time]") {
    auto dictionary = tests::shipped_dictionary();
    REQUIRE(dictionary.clock.size() == 1);
    const auto* first = dictionary.clock_at(Sclk{397501715.0});
    REQUIRE(first != nullptr);
    CHECK(first->version == 1);
    CHECK(first->rate == 1.0);
    CHECK(first->leap_seconds == 35);  // ET - UTC = 67.184 s = 32.184 s + TAI - UTC
    CHECK(day_of_year_text(first->scet_of(Sclk{397501715.0})) == "2012-219T05:10:47.400");
    auto later = dictionary.clock.front();
    later.valid_from = Sclk{397600000.0};
    later.correlation.version = 2;
    dictionary.clock.push_back(later);
    CHECK(dictionary.clock_at(Sclk{397599999.0})->version == 1);
    CHECK(dictionary.clock_at(Sclk{397600000.0})->version == 2);
    dictionary.clock.front().valid_from = Sclk{1.0};
    CHECK(dictionary.clock_at(Sclk{0.0}) == nullptr);
}

TEST_CASE("what only ground knows changes neither the dictionary's id nor the timeline's version",
          "[dictionary][time][invariant1]") {
    const tests::MissionCopy mission;
    std::string text = mission.text("clock_correlation.csv");
    text.replace(text.find(".400,0,35"), 9, ".400,1e-6,35");
    mission.write("clock_correlation.csv", text);
    text = mission.text("predicted_anchors.csv");
    text.replace(text.find("255.9"), 5, "256.5");
    mission.write("predicted_anchors.csv", text);
    const auto loaded = mission.load();
    REQUIRE(loaded.dictionary);
    CHECK(loaded.dictionary->clock.front().correlation.rate == 1.0 + 1.0e-6);
    CHECK(loaded.dictionary->id == tests::shipped_dictionary().id);
    CHECK(loaded.dictionary->timeline_version == tests::shipped_dictionary().timeline_version);
}

}  // namespace dictionaries_ground_sheets_test
