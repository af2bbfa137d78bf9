// SPDX-License-Identifier: Apache-2.0
// A run of our own mission that was recorded elsewhere: nobody said when entry was.
#include "server/archive/reader.hpp"
#include "server/archive/run_differences.hpp"
#include "server/archive/sqlite.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace archive_unknown_entry_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::RunId;

namespace {

/// Two runs with the same packets: entry of the first is known.
struct TwoRuns {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();

    TwoRuns() {
        auto archive = std::move(archive::Archive::open(folder / "a.db")).value();
        pipeline::Pipeline pipeline{archive, dictionary};
        for (const double entry_s : {1000.0, 0.0}) {
            archive::RunStart start;
            start.entry = Sclk{entry_s};
            REQUIRE(pipeline.begin(start).ok());
            REQUIRE(pipeline.accept(live(fired_packet(1, 1010.0, 1))).ok());
            REQUIRE(pipeline.accept(live(mortar_packet(2, 1020.0, 400.0F))).ok());
            REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
        }
    }
    archive::Reader reader() const { return std::move(archive::Reader::open(folder / "a.db", dictionary)).value(); }
};

}  // namespace

TEST_CASE("where nobody knows when entry was, the as-flown report counts no time from it, nor predicts one",
          "[archive][times]") {
    const TwoRuns runs;
    auto reader = runs.reader();
    for (const bool is_known : {true, false}) {
        const auto report = reader.as_flown(RunId{is_known ? 1U : 2U});
        REQUIRE(report.ok());
        CHECK(report->timepoints(1).has_realtime_e_s() == is_known);
        REQUIRE(report->events_size() == 1);
        CHECK(report->events(0).has_realtime_e_s() == is_known);
        for (const auto& row : report->timepoints()) CHECK((is_known || !row.has_predicted_e_s()));
    }
}

TEST_CASE("where nobody knows when entry was, the SQL views have no seconds from it and no date of it",
          "[archive][times]") {
    const TwoRuns runs;
    auto database = sqlite::Database::open((runs.folder / "a.db").string(), sqlite::Mode::read_only);
    REQUIRE(database.ok());
    for (const char* const view : {"event_log WHERE e_s IS NULL", "timeline_log WHERE e_s IS NULL",
                                   "clock_log WHERE entry_sclk IS NULL AND entry_scet IS NULL"}) {
        INFO(view);
        const auto runs_of = [&](const char* what) {
            return database->integer_of(("SELECT " + std::string{what} + "(run) FROM " + view).c_str()).value();
        };
        CHECK(runs_of("min") == 2);
        CHECK(runs_of("max") == 2);
    }
}

TEST_CASE("a run whose entry nobody knows is compared with none", "[archive][times]") {
    const TwoRuns runs;
    auto reader = runs.reader();
    for (const auto& [one, other] : {std::pair{1U, 2U}, {2U, 1U}}) {
        const auto told = archive::differences(reader, runs.dictionary, RunId{one}, RunId{other});
        REQUIRE_FALSE(told.ok());
        CHECK(told.error().message == "runs are compared from entry, and nobody knows when run 2 has it");
    }
}

}  // namespace archive_unknown_entry_test
