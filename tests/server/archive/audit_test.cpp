// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/reader.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace archive_audit_test {

using namespace aeolis;
using namespace aeolis::archive;

namespace {

AuditRecord record(const std::string& detail) {
    return {"2026-11-22T12:00:00Z", "dina", "127.0.0.1", "command", detail, "done"};
}

/// An archive with five entries, written in two goes.
void write_five(const std::filesystem::path& file) {
    auto archive = Archive::open(file);
    REQUIRE(archive);
    REQUIRE(archive->append_audit(std::vector{record("one"), record("two"), record("three")}));
    REQUIRE(archive->append_audit(std::vector{record("four"), record("five")}));
}

sqlite::Database opened(const std::filesystem::path& file) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    REQUIRE(database);
    return std::move(*database);
}

}  // namespace

TEST_CASE("entries of the audit come back in order and hang together", "[archive][audit]") {
    const test::TemporaryFolder folder;
    write_five(folder / "a.db");
    auto reader = Reader::open(folder / "a.db", tests::shipped_dictionary());
    REQUIRE(reader);
    const auto two = reader->audit(2, 2);
    REQUIRE(two);
    REQUIRE(two->size() == 2);
    CHECK((*two)[0].detail == "three");
    CHECK((*two)[1].entry == 4);
    auto database = opened(folder / "a.db");
    const auto check = check_audit(database);
    REQUIRE(check);
    CHECK(check->faults.empty());
    CHECK(check->entries == 5);
    CHECK(check->last_hash.size() == 64);
}

TEST_CASE("an entry of the audit that was changed, taken out or put between is found", "[archive][audit]") {
    for (const char* crime :
         {"UPDATE audit SET who = 'carl' WHERE entry = 3",
          "UPDATE audit SET detail = 'tw' , outcome = 'odone' WHERE entry = 2", "DELETE FROM audit WHERE entry = 2",
          "DELETE FROM audit WHERE entry = 1",
          "INSERT INTO audit SELECT 6, at, who, peer, action, detail, outcome, hash FROM audit WHERE entry = 5",
          "UPDATE audit SET hash = (SELECT hash FROM audit WHERE entry = 2) WHERE entry = 3"}) {
        const test::TemporaryFolder folder;
        write_five(folder / "a.db");
        auto database = opened(folder / "a.db");
        REQUIRE(database.execute(crime));
        const auto check = check_audit(database);
        REQUIRE(check);
        INFO(crime);
        CHECK(check->faults.size() == 1);
    }
}

TEST_CASE("no two entries of the audit that differ are hashed alike by moving what stands in them", "[audit]") {
    AuditEntry one, two;
    one.who = "ab";
    one.from = "c";
    two.who = "a";
    two.from = "bc";
    CHECK(audit_hash("", one) != audit_hash("", two));
}

}  // namespace archive_audit_test
