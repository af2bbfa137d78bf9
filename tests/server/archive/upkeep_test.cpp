// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/upkeep.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <atomic>
#include <fstream>
#include <sys/stat.h>
#include <thread>

namespace archive_upkeep_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace aeolis::archive;

namespace {

/// `runs` finished runs of 2500 navigation packets each.
void record(const std::filesystem::path& file, const dictionary::Dictionary& dictionary, int runs) {
    auto archive = std::move(Archive::open(file)).value();
    pipeline::Pipeline pipeline(archive, dictionary);
    for (int run = 0; run < runs; ++run) {
        RunStart start;
        start.scenario = "nominal";
        start.solution = {{"latitude_deg", -4.5}};
        REQUIRE(pipeline.begin(start).ok());
        for (std::size_t i = 0; i < 2500; ++i)
            REQUIRE(pipeline
                        .accept(live(navigation_packet(static_cast<std::uint16_t>(i), static_cast<double>(i) / 64.0,
                                                       static_cast<float>(i), 3.0F)))
                        .ok());
        REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
    }
}

std::int64_t ask(const std::filesystem::path& file, const char* sql) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    auto answer = database->integer_of(sql);
    REQUIRE(answer.ok());
    return *answer;
}

}  // namespace

TEST_CASE("pruned runs are gone from every table, are noted, and their numbers are not given again",
          "[archive][prune]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto file = folder / "a.db";
    record(file, dictionary, 3);
    {
        auto archive = Maintenance::open(file);
        REQUIRE(archive.ok());
        const auto lines = run_lines(archive->database());
        REQUIRE(lines->size() == 3);
        CHECK(lines->back().packets == 2500);
        archive::AuditRecord by;
        by.who = "nina";
        by.from = "command line";
        CHECK_FALSE(prune(*archive, {RunId{1}, RunId{9}}, by).ok());  // all or none
        CHECK(run_lines(archive->database())->size() == 3);
        REQUIRE(prune(*archive, {RunId{1}, RunId{3}}, by).ok());
    }
    for (const auto& table : run_tables()) {
        INFO(table.name);
        const auto total = ask(file, (std::string("SELECT count(*) FROM ") + table.name).c_str());
        std::string of_second = table.rows;
        for (auto at = of_second.find("?1"); at != std::string::npos; at = of_second.find("?1"))
            of_second.replace(at, 2, "2");
        CHECK(total == ask(file, (std::string("SELECT count(*) FROM ") + table.name + " WHERE " + of_second).c_str()));
    }
    CHECK(ask(file, "SELECT count(*) FROM packets") == 2500);
    CHECK(ask(file, "SELECT count(*) FROM pruned_runs WHERE scenario = 'nominal'") == 2);
    CHECK(ask(file, "SELECT count(*) FROM audit WHERE action <> 'fingerprint'") == 1);  // the refused one did nothing
    CHECK(ask(file, "SELECT count(*) FROM audit WHERE who = 'nina' AND peer = 'command line' AND action = 'prune' AND "
                    "detail = 'runs 1, 3' AND outcome = 'done'") == 1);
    CHECK(pipeline::verify(file, {}, dictionary, nullptr, folder / "")->faults.empty());
    auto archive = Archive::open(file);
    CHECK(*archive->begin_run({}, dictionary) == RunId{4});
}

TEST_CASE("every table of a run is known to prune", "[archive][prune]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    {
        REQUIRE(Archive::open(file).ok());
    }
    std::string known =
        "'dictionaries', 'dictionary_channels', 'dictionary_packets', 'words', 'pruned_runs', 'audit', 'layouts',"
        " 'forecasts'";
    for (const auto& table : run_tables()) known += std::string(", '") + table.name + "'";
    CHECK(ask(file, ("SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%' AND name NOT "
                     "LIKE 'search_%' AND name NOT IN (" +
                     known + ")")
                        .c_str()) == 0);
}

TEST_CASE("a pruning that a crash cut off is gone on with, piece by piece, and nothing of the run is left",
          "[archive][prune]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto file = folder / "a.db";
    record(file, dictionary, 2);
    const auto before = std::filesystem::file_size(file);
    for (int stop_after = 3;; stop_after += 7) {  // each time the archive is opened anew
        auto archive = std::move(Archive::open(file)).value();
        if (stop_after == 3) REQUIRE(archive.prune(RunId{1}, {}).ok());
        auto more = Result<bool>{true};
        for (int i = 0; i < stop_after && *more; ++i) {
            more = archive.remove_pruned();
            REQUIRE(more.ok());
        }
        CHECK(pipeline::verify(file, {}, dictionary, nullptr, folder / "")->faults == std::vector<std::string>{});
        if (!*more) break;
        REQUIRE(stop_after < 1000);
    }
    for (const auto& table : run_tables()) {
        INFO(table.name);
        std::string of_first = table.rows;
        for (auto at = of_first.find("?1"); at != std::string::npos; at = of_first.find("?1"))
            of_first.replace(at, 2, "1");
        CHECK(ask(file, (std::string("SELECT count(*) FROM ") + table.name + " WHERE " + of_first).c_str()) == 0);
    }
    CHECK(ask(file, "SELECT count(*) FROM packets") == 2500);
    CHECK(ask(file, "PRAGMA freelist_count") == 0);
    CHECK(std::filesystem::file_size(file) < before * 9 / 10);
    auto archive = std::move(Archive::open(file)).value();
    CHECK(archive.prune(RunId{1}, {}).error().message.find("no run 1 that is over") == 0);
    CHECK(*archive.begin_run({}, dictionary) == RunId{3});
    CHECK_FALSE(archive.prune(RunId{3}, {}).ok());  // it goes on
}

TEST_CASE("a run that is pruned while the rows of another go is removed as well", "[archive][prune]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto file = folder / "a.db";
    record(file, dictionary, 3);
    auto archive = std::move(Archive::open(file)).value();
    REQUIRE(archive.prune(RunId{1}, {}).ok());
    REQUIRE(*archive.remove_pruned());
    REQUIRE(archive.prune(RunId{2}, {}).ok());
    for (int pieces = 0; *archive.remove_pruned(); ++pieces) REQUIRE(pieces < 1000);
    CHECK(ask(file, "SELECT count(DISTINCT key >> 40) FROM packets") == 1);
    CHECK(ask(file, "PRAGMA freelist_count") == 0);
}

TEST_CASE("pruning gives the room of the runs back, and vacuum does not undo it", "[archive][prune]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    record(file, small_dictionary(), 8);  // beside which a page for each of the tables is little
    const auto before = std::filesystem::file_size(file);
    auto archive = Maintenance::open(file);
    REQUIRE(prune(*archive, {{RunId{1}, RunId{2}, RunId{3}, RunId{4}, RunId{5}, RunId{6}, RunId{7}}}, {}).ok());
    CHECK(std::filesystem::file_size(file) < before * 2 / 3);
    REQUIRE(vacuum(*archive).ok());
    CHECK(std::filesystem::file_size(file) < before * 2 / 3);
}

TEST_CASE("a backup is a whole archive of one moment while its writer goes on", "[archive][backup]") {
    TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    const auto file = folder / "a.db";
    std::atomic<bool> stop = false;
    std::atomic<std::uint64_t> written = 0;
    {
        auto made = Archive::open(file);
        REQUIRE(made.ok());
    }
    std::thread writer{[&] {
        auto archive = std::move(Archive::open(file)).value();
        pipeline::Pipeline pipeline(archive, dictionary);
        if (!pipeline.begin({}).ok()) return;
        for (std::size_t i = 0; !stop; ++i) {
            const auto count = static_cast<std::uint16_t>(i & 0x3FFFU);
            if (!pipeline.accept(live(navigation_packet(count, static_cast<double>(i) / 64.0, 1.0F, 7000.0F))).ok())
                return;
            if (i % 50 == 49 && !pipeline.commit().ok()) return;
            written = pipeline.last_durable();
        }
    }};
    std::uint64_t copied = 0;
    for (int i = 0; i < 5; ++i) {
        const auto since = written.load();
        while (written < since + 3000)  // it writes before, during and after each copy
            std::this_thread::yield();
        const auto copy = folder / ("copy" + std::to_string(i)).c_str();
        const auto before = written.load();
        const auto done = backup(file, copy);
        INFO((done ? "" : done.error().message));
        REQUIRE(done.ok());
        CHECK_FALSE(std::filesystem::exists(folder / ("copy" + std::to_string(i) + "-wal").c_str()));
        const auto found = pipeline::verify(copy, {}, dictionary, nullptr, folder / "");
        REQUIRE(found.ok());
        CHECK(found->faults.empty());
        auto reader = Reader::open(copy, dictionary);
        const auto last = reader->last_seq(RunId{1});
        REQUIRE(last.ok());
        CHECK(*last >= before);
        CHECK(*last > copied);
        copied = *last;
    }
    const auto while_copied = written.load();
    stop = true;
    writer.join();
    CHECK(while_copied >= 15'000);
    CHECK(backup(file, folder / "copy0").error().message ==
          (folder / "copy0").string() + " is there already: nothing is overwritten");
}

TEST_CASE("a backup that fails leaves no file under its name", "[archive][backup]") {
    TemporaryFolder folder;
    const auto file = folder / "notes.db";
    std::ofstream(file) << std::string(5000, 'x');
    CHECK(backup(file, folder / "copy").error().message == file.string() + " is not an Aeolis archive");
    record(folder / "a.db", small_dictionary(), 1);
    CHECK_FALSE(backup(folder / "a.db", folder / "none/copy").ok());
    CHECK_FALSE(std::filesystem::exists(folder / "copy"));
    CHECK_FALSE(std::filesystem::exists(folder / "copy-partial"));
}

TEST_CASE("a new archive, its log, its shared memory and its copies are their owner's alone, whatever the umask; an "
          "older file keeps its mode, and that is told",
          "[archive][backup]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    const auto mode = [&](const std::string& name) {
        return std::filesystem::status(folder / name.c_str()).permissions() & std::filesystem::perms::all;
    };
    using std::filesystem::perms;
    constexpr auto owner_only = perms::owner_read | perms::owner_write;
    const auto before = ::umask(0);
    const std::shared_ptr<void> at_the_end{nullptr, [before](void*) { ::umask(before); }};
    {
        auto archive = std::move(Archive::open(file)).value();
        for (const char* name : {"a.db", "a.db-wal", "a.db-shm"}) CHECK(mode(name) == owner_only);
        CHECK_FALSE(open_to_others(file));
        REQUIRE(backup(file, folder / "copy").ok());
        CHECK(mode("copy") == owner_only);
    }
    std::filesystem::permissions(file, perms::group_read, std::filesystem::perm_options::add);
    auto archive = std::move(Archive::open(file)).value();
    for (const char* name : {"a.db", "a.db-wal", "a.db-shm"}) CHECK(mode(name) == (owner_only | perms::group_read));
    CHECK_THAT(open_to_others(file).value(), Catch::StartsWith(file.string() + " may be read or written by others"));
}

TEST_CASE("numbers that no item has, or two have, are named", "[archive][verify]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    record(file, small_dictionary(), 1);
    auto database = std::move(sqlite::Database::open(file.string(), sqlite::Mode::read_write_create)).value();
    CHECK(sequence_faults(database, RunId{1}, "main.", 10)->empty());
    REQUIRE(database
                .execute("DELETE FROM packets WHERE key = (1 << 40) + 11; INSERT INTO link_changes VALUES ((1 << 40) + "
                         "21, 0, 1, 1, NULL, '', 0, NULL);"
                         "UPDATE packets SET sampled = 0 WHERE key = (1 << 40) + 31")
                .ok());
    CHECK(*sequence_faults(database, RunId{1}, "main.", 10) ==
          std::vector<std::string>{"run 1: no item has the numbers 11 to 12", "run 1: two items have the number 21",
                                   "run 1: no item has the number 32"});
}

}  // namespace archive_upkeep_test
