// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <fstream>
#include <iostream>
#include <sys/stat.h>
#include <unistd.h>

namespace archive_archive_test {

using namespace aeolis;
using namespace aeolis::archive;
using test::TemporaryFolder;

namespace {

/// One packet a sequence number, from `first`.
Batch packets(Sequence first, std::size_t count) {
    Batch batch;
    batch.first_seq = first;
    batch.last_seq = first + count - 1;
    for (std::size_t i = 0; i < count; ++i) {
        PacketRecord record;
        record.seq = first + i;
        record.apid = test::status_apid;
        record.packet = std::uint16_t{1};
        record.link = "uhf_live";
        record.source = Source::realtime;
        record.sclk = Sclk{static_cast<double>(record.seq)};
        const auto octets = test::status_packet(static_cast<std::uint16_t>(record.seq), record.sclk.seconds, 1);
        record.octets = {batch.octets.size(), octets.size()};
        batch.octets.insert(batch.octets.end(), octets.begin(), octets.end());
        batch.packets.push_back(record);
    }
    return batch;
}

std::int64_t ask(const std::filesystem::path& file, const char* sql) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    REQUIRE(database.ok());
    auto answer = database->integer_of(sql);
    REQUIRE(answer.ok());
    return *answer;
}

}  // namespace

TEST_CASE("a new archive is an SQLite file that names its program and schema", "[archive][R43]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    {
        REQUIRE(Archive::open(file).ok());
    }
    CHECK(ask(file, "PRAGMA application_id") == application_id);
    CHECK(ask(file, "PRAGMA user_version") == schema_version);
    CHECK(ask(file, "SELECT count(*) FROM packets") == 0);
    CHECK_FALSE(std::filesystem::exists(folder / "a.db-writer"));
}

TEST_CASE("what is not an archive is refused by name and left as it was", "[archive]") {
    TemporaryFolder folder;
    SECTION("text") {
        const auto file = folder / "notes.db";
        std::ofstream(file) << std::string(5000, 'x');
        const auto opened = Archive::open(file);
        REQUIRE_FALSE(opened.ok());
        CHECK(opened.error().message == file.string() + " is not an Aeolis archive");
        CHECK(std::filesystem::file_size(file) == 5000);
    }
    SECTION("another program's database") {
        const auto file = folder / "other.db";
        {
            auto other = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
            REQUIRE(other->execute("CREATE TABLE t(x)").ok());
        }
        const auto opened = Archive::open(file);
        REQUIRE_FALSE(opened.ok());
        CHECK(opened.error().message == file.string() + " is not an Aeolis archive");
        CHECK(ask(file, "SELECT count(*) FROM sqlite_schema") == 1);
    }
    SECTION("another schema, as that of a later build") {
        const auto file = folder / "other_schema.db";
        {
            REQUIRE(Archive::open(file).ok());
        }
        {
            auto other = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
            REQUIRE(other->execute("PRAGMA user_version = 4").ok());
        }
        const std::string line = file.string() + " has archive schema 4, this program has 1: open it with the Aeolis "
                                                 "that wrote it, or name another file";
        const auto opened = Archive::open(file);
        REQUIRE_FALSE(opened.ok());
        CHECK(opened.error().message == line);
        const auto read = Reader::open(file, test::small_dictionary());
        REQUIRE_FALSE(read.ok());
        CHECK(read.error().message == line);
        CHECK(ask(file, "PRAGMA user_version") == 4);
    }
    SECTION("the mark of builds before the first release") {
        const auto file = folder / "early.db";
        {
            auto early = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
            REQUIRE(early->execute("PRAGMA application_id = 0x41454F4C; PRAGMA user_version = 1").ok());
        }
        const std::string line = file.string() +
                                 " was written before the first release, in another layout: open it with "
                                 "the Aeolis that wrote it, or name another file";
        CHECK(Archive::open(file).error().message == line);
        CHECK(Reader::open(file, test::small_dictionary()).error().message == line);
    }
    SECTION("an archive of a build with other counters of links") {
        const auto file = folder / "older.db";
        REQUIRE(Archive::open(file).ok());
        {
            auto older = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
            REQUIRE(older->execute("ALTER TABLE link_totals DROP COLUMN corrected_headers").ok());
        }
        const std::string line =
            file.string() + " was written by a build of before 0.2.0, with other counters of links: open it with the "
                            "Aeolis that wrote it, or name another file";
        CHECK(Archive::open(file).error().message == line);
        CHECK(Reader::open(file, test::small_dictionary()).error().message == line);
    }
    SECTION("a mark without tables") {
        const auto file = folder / "marked.db";
        {
            auto marked = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
            REQUIRE(marked->execute("PRAGMA application_id = 0x41454F31").ok());
        }
        CHECK_FALSE(Archive::open(file).ok());
    }
    SECTION("a folder, and a folder that is not there") {
        CHECK_FALSE(Archive::open(folder / "").ok());
        CHECK_FALSE(Archive::open(folder / "none/a.db").ok());
    }
}

TEST_CASE("an archive has one writer", "[archive]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto first = Archive::open(file);
    REQUIRE(first.ok());
    const auto second = Archive::open(file);
    REQUIRE_FALSE(second.ok());
    CHECK(second.error().message == file.string() + " is being written by another process");
    CHECK((std::filesystem::status(file.string() + "-writer").permissions() & std::filesystem::perms::all) ==
          (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
    first = Error{"closed"};
    CHECK(Archive::open(file).ok());
}

TEST_CASE("what root writes leaves a lock that whose the archive is can take", "[archive]") {
    if (::geteuid() != 0) return void(std::cout << "SKIPPED: only root has files that are not its own\n");
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    {
        REQUIRE(Archive::open(file).ok());
    }
    constexpr uid_t nobody = 65534;
    REQUIRE(::chown(file.c_str(), nobody, nobody) == 0);
    const auto held = Archive::open(file);
    REQUIRE(held.ok());
    struct stat lock{};
    REQUIRE(::stat((file.string() + "-writer").c_str(), &lock) == 0);
    CHECK(lock.st_uid == nobody);
}

TEST_CASE("a link in the place of the writer's lock is not followed, and what it leads to stays whose it was",
          "[archive]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db", other = folder / "another's";
    {
        std::ofstream{other} << "";
    }
    std::filesystem::create_symlink(other, file.string() + "-writer");
    const auto refused = Archive::open(file);
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.error().message.find("a.db-writer") != std::string::npos);
    CHECK(std::filesystem::exists(other));
}

TEST_CASE("a file that another program holds is refused in one line that names it", "[archive]") {
    TemporaryFolder folder;
    const auto file = folder / "held.db";
    auto other = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    REQUIRE(other->execute("CREATE TABLE t(x); BEGIN EXCLUSIVE").ok());
    const auto opened = Archive::open(file);
    REQUIRE_FALSE(opened.ok());
    CHECK(opened.error().message == file.string() + ": database is locked");
}

TEST_CASE("a batch is stored whole or not at all, and may be given again", "[archive]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto archive = Archive::open(file);
    REQUIRE(archive.ok());
    const auto run = archive->begin_run({}, test::small_dictionary());
    REQUIRE(run.ok());
    REQUIRE(archive->append(*run, packets(1, 10)).ok());

    auto batch = packets(11, 10);
    batch.packets.back().seq = 5;  // taken: the ten before it must not be stored either
    CHECK_FALSE(archive->append(*run, batch).ok());
    CHECK(ask(file, "SELECT count(*) FROM packets") == 10);

    batch.packets.back().seq = 20;
    CHECK(archive->append(*run, batch).ok());
    CHECK(ask(file, "SELECT count(*) FROM packets") == 20);
    CHECK(ask(file, "SELECT max(seq) FROM packet_log") == 20);
}

TEST_CASE("runs are numbered in one file and keep their packets apart", "[archive][R43]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto archive = Archive::open(file);
    const auto dictionary = test::small_dictionary();
    const auto first = archive->begin_run({}, dictionary);
    REQUIRE(archive->append(*first, packets(1, 3)).ok());
    Batch end;
    end.end = RunEnd{archive::Outcome::touchdown, "", "abc", "2026-01-01T00:00:00Z"};
    REQUIRE(archive->append(*first, end).ok());
    const auto second = archive->begin_run({}, dictionary);
    CHECK(second->value == first->value + 1);
    REQUIRE(archive->append(*second, packets(1, 4)).ok());
    CHECK(ask(file, "SELECT count(*) FROM packets WHERE run = 1") == 3);
    CHECK(ask(file, "SELECT count(*) FROM packet_log WHERE run = 2 AND name = 'Status'") == 4);
    CHECK(ask(file, "SELECT last_seq FROM runs WHERE run = 1 AND state = 'finished'") == 3);
    CHECK(ask(file, "SELECT count(*) FROM dictionaries") == 1);
}

TEST_CASE("the archive keeps with each run the version of the timeline that it flew", "[archive][timeline][R20]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    auto archive = Archive::open(file);
    auto dictionary = test::small_dictionary();
    const auto first = archive->begin_run({}, dictionary);
    REQUIRE(first.ok());
    Batch end;
    end.end = RunEnd{archive::Outcome::touchdown, "", "abc", "2026-01-01T00:00:00Z"};
    REQUIRE(archive->append(*first, end).ok());
    ++dictionary.id;
    dictionary.timeline_version = 4;
    REQUIRE(archive->begin_run({}, dictionary).ok());
    for (const char* run : {"1", "2"})
        CHECK(ask(file, (std::string{"SELECT d.timeline_version FROM runs JOIN dictionaries d USING (dictionary) "
                                     "WHERE run = "} +
                         run)
                            .c_str()) == (*run == '1' ? 3 : 4));
}

TEST_CASE("a run that was cut off is marked interrupted, with its last sequence number", "[archive]") {
    TemporaryFolder folder;
    const auto file = folder / "a.db";
    {
        auto archive = Archive::open(file);
        const auto run = archive->begin_run({}, test::small_dictionary());
        auto batch = packets(1, 7);
        batch.packets.back().sampled = true;  // its samples are item 8
        batch.last_seq = 8;
        REQUIRE(archive->append(*run, batch).ok());
    }
    auto archive = Archive::open(file);
    REQUIRE(archive->interrupted().size() == 1);
    CHECK(archive->interrupted().front() == RunId{1});
    CHECK(ask(file, "SELECT last_seq FROM runs WHERE state = 'interrupted'") == 8);
}

}  // namespace archive_archive_test
