// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/archive_comparison.hpp"
#include "server/archive/run_rows.hpp"
#include "server/archive/shared_archive.hpp"
#include "server/archive/upkeep.hpp"
#include "tests/server/run_copies.hpp"
#include "tests/support/catch.hpp"

#include <fmt/ranges.h>

namespace server_cluster_run_rows_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace aeolis::archive;

namespace {

/// Takes a run over, step by step; `between` sees each step before it is taken.
template <typename Between>
void copy_run(RunRowsReader& from, SharedArchive& to, RunId run, Between between) {
    for (int steps = 0; steps < 1000; ++steps) {
        const auto here = to.position(run);
        REQUIRE(here);
        auto step = from.next(run, *here, true);
        REQUIRE(step);
        if (!*step) return;
        between(**step);
        const auto octets = packed((*step)->rows);
        auto rows = unpacked(octets);
        REQUIRE(rows);
        (*step)->rows = std::move(*rows);
        const auto taken = to.take(run, **step, "stream 1");
        INFO((taken ? "" : taken.error().message));
        REQUIRE(taken);
    }
    FAIL("a run without end");
}
void copy_run(RunRowsReader& from, SharedArchive& to, RunId run) {
    copy_run(from, to, run, [](const auto&) {});
}

/// An archive that follows the one of `origin`.
SharedArchive following(const std::filesystem::path& file, const std::filesystem::path& origin) {
    auto of_origin = SharedArchive::open(origin);
    REQUIRE(of_origin);
    auto shared = SharedArchive::open(file);
    REQUIRE(shared);
    const auto identity = of_origin->identity();
    REQUIRE(identity);
    REQUIRE(shared->follow(*identity));
    return std::move(*shared);
}

}  // namespace

TEST_CASE("a run that is taken over step by step has every row of its origin, and its fingerprint",
          "[archive][cluster][R61]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto origin = folder / "origin.db", copy = folder / "copy.db";
    auto written = Archive::open(origin);
    REQUIRE(written);
    for (int run = 0; run < 2; ++run) record_run(*written, dictionary, 5'000);
    add_note(*written, RunId{1}, "after the end");
    auto archive = Archive::open(copy);
    REQUIRE(archive);
    auto shared = following(copy, origin);
    auto reader = RunRowsReader::open(origin);
    REQUIRE(reader);
    std::size_t steps = 0;
    for (const RunId run : {RunId{2}, RunId{1}}) copy_run(*reader, shared, run, [&](const auto&) { ++steps; });
    CHECK(steps >= 4);  // no step holds a run
    CHECK(rows_of_runs(copy) == rows_of_runs(origin));
    CHECK(faults_of(copy).empty());
    const auto compared = compare(origin, copy);
    REQUIRE(compared);
    CHECK(compared->differences.empty());
    CHECK(compared->runs == 2);
    CHECK(compared->rows > 10'000);
    SECTION("and what is added later is taken too") {
        add_note(*written, RunId{2}, "the day after");
        const auto differ = compare(copy, origin);
        REQUIRE(differ);
        REQUIRE(differ->differences.size() == 3);  // the note, the run's last item, the search index
        CHECK_THAT(fmt::format("{}", fmt::join(differ->differences, "; ")),
                   Catch::Contains("notes: 0 rows only in") && Catch::Contains("1 only in") &&
                       Catch::Contains("search: 0 rows only in"));
        copy_run(*reader, shared, RunId{2});
        CHECK(rows_of_runs(copy) == rows_of_runs(origin));
        CHECK(faults_of(copy).empty());
    }
}

TEST_CASE("a run that goes on is in its copy up to each commit, and steps that come again change nothing",
          "[archive][cluster][R61]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto origin = folder / "origin.db", copy = folder / "copy.db";
    auto written = Archive::open(origin);
    auto archive = Archive::open(copy);
    REQUIRE(written);
    REQUIRE(archive);
    pipeline::Pipeline pipeline{*written, dictionary};
    REQUIRE(pipeline.begin({}));
    auto shared = following(copy, origin);
    auto reader = RunRowsReader::open(origin);
    REQUIRE(reader);
    std::vector<RunStep> all;
    for (std::uint16_t count = 0; count < 2'000; ++count) {
        REQUIRE(pipeline.accept(navigation(count)));
        if (count % 500 != 499) continue;
        REQUIRE(pipeline.commit());
        copy_run(*reader, shared, RunId{1}, [&](const auto& step) { all.push_back(step); });
        CHECK(rows_of_runs(copy) == rows_of_runs(origin));
    }
    REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}));
    copy_run(*reader, shared, RunId{1}, [&](const auto& step) { all.push_back(step); });
    const auto rows = rows_of_runs(copy);
    CHECK(rows == rows_of_runs(origin));
    for (const auto& step : all) REQUIRE(shared.take(RunId{1}, step, "stream 1"));
    CHECK(rows_of_runs(copy) == rows);
    CHECK(faults_of(copy).empty());
}

TEST_CASE("a step that leaves out an item, holds a foreign row or is damaged is refused whole",
          "[archive][cluster][R61]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto origin = folder / "origin.db", copy = folder / "copy.db";
    auto written = Archive::open(origin);
    auto archive = Archive::open(copy);
    REQUIRE(written);
    REQUIRE(archive);
    record_run(*written, dictionary, 200);
    record_run(*written, dictionary, 200);
    auto shared = following(copy, origin);
    auto reader = RunRowsReader::open(origin);
    REQUIRE(reader);
    const auto step = reader->next(RunId{1}, {}, true);
    reader->forget(RunId{2});
    const auto other = reader->next(RunId{2}, {}, true);
    REQUIRE(step);
    REQUIRE(*step);
    REQUIRE(other);
    const auto refused = [&](auto change) {
        auto changed = **step;
        change(changed);
        const auto taken = shared.take(RunId{1}, changed, "stream 1");
        CHECK_FALSE(taken);
        if (!taken) CHECK_FALSE(taken.error().internal);
        CHECK(rows_of_runs(copy).empty());
    };
    const auto table = [](RunStep& of, const std::string& name) -> v1::TableRows& {
        for (auto& rows : *of.rows.mutable_tables())
            if (rows.table() == name) return rows;
        throw std::runtime_error(name);
    };
    refused([](RunStep& changed) { changed.after.set_seq(changed.after.seq() + 1); });
    refused([](RunStep& changed) { changed.after.set_seq(changed.after.seq() - 1); });
    refused([](RunStep& changed) { changed.before.set_seq(10); });
    refused([&](RunStep& changed) { table(changed, "packets").clear_rows(); });
    refused([&](RunStep& changed) { table(changed, "packets").mutable_values()->resize(100); });
    refused([&](RunStep& changed) { table(changed, "packets").set_table("audit"); });
    refused([&](RunStep& changed) { table(changed, "packets").set_table("packets; DROP TABLE packets"); });
    refused([&](RunStep& changed) {
        auto of_other = **other;
        table(changed, "packets") = table(of_other, "packets");
    });
    refused([&](RunStep& changed) {
        auto& last = table(changed, "packets").mutable_values()->back();  // of a packet's octets
        last = static_cast<char>(last + 1);
    });
    CHECK_FALSE(unpacked("no rows"));
    REQUIRE(shared.take(RunId{1}, **step, "stream 1"));
}

TEST_CASE("an archive that follows has no runs of its own, and its runs go on elsewhere", "[archive][cluster][R61]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto origin = folder / "origin.db", copy = folder / "copy.db", own = folder / "own.db";
    auto written = Archive::open(origin);
    REQUIRE(written);
    REQUIRE(written->begin_run({}, dictionary));
    std::string identity;
    {
        auto archive = Archive::open(copy);
        REQUIRE(archive);
        auto shared = following(copy, origin);
        auto reader = RunRowsReader::open(origin);
        REQUIRE(reader);
        copy_run(*reader, shared, RunId{1});
        identity = *shared.followed();
        CHECK(*shared.identity() != identity);
        CHECK_FALSE(shared.follow("another"));
    }
    {
        auto archive = Archive::open(copy);
        REQUIRE(archive);
        CHECK(archive->interrupted().empty());
        REQUIRE(SharedArchive::open(copy)->stop_following());
    }
    CHECK(Archive::open(copy)->interrupted() == std::vector{RunId{1}});

    auto archive = Archive::open(own);
    REQUIRE(archive);
    REQUIRE(archive->begin_run({}, dictionary));
    CHECK_FALSE(SharedArchive::open(own)->follow(identity));
    REQUIRE(backup(origin, folder / "backup.db"));
    auto backed_up = Archive::open(folder / "backup.db");
    REQUIRE(backed_up);
    auto shared = SharedArchive::open(folder / "backup.db");
    CHECK(*shared->identity() == identity);
    REQUIRE(shared->follow(identity));
    CHECK(*shared->identity() != identity);
}

}  // namespace server_cluster_run_rows_test
