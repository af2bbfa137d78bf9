// SPDX-License-Identifier: Apache-2.0
#include "server/archive/schema.hpp"
#include "server/archive/sqlite.hpp"
#include "server/archive/upkeep.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace archive_derivation_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::RunId;
namespace sqlite = archive::sqlite;

namespace {

/// Two runs with all that packets can say, live and recorded, good and broken; the second was cut off.
struct Recorded {
    TemporaryFolder folder;
    std::filesystem::path file = folder / "a.db";
    dictionary::Dictionary dictionary = small_dictionary();

    Recorded() {
        auto archive = std::move(Archive::open(file)).value();
        pipeline::Pipeline pipeline(archive, dictionary);
        for (const bool finished : {true, false}) {
            REQUIRE(pipeline.begin({}).ok());
            for (std::size_t i = 0; i < 3000; ++i) {
                const double sclk_s = 1000.0 + static_cast<double>(i) / 64.0;
                const auto count = static_cast<std::uint16_t>(i);
                const float speed_mps = i / 500 % 2 == 0 ? 5000.0F : 7000.0F;  // in and out of its limit
                const auto altitude_m = i % 7 == 0 ? std::nullopt : std::optional(static_cast<float>(i));
                auto packet = navigation_packet(count, sclk_s, altitude_m, speed_mps);
                REQUIRE(pipeline.accept(live(packet)).ok());
                if (i % 3 == 0) REQUIRE(pipeline.accept(recorded(packet)).ok());
                if (i % 1000 == 0) REQUIRE(pipeline.accept(live(mortar_packet(count, sclk_s, 400.0F))).ok());
                if (i % 1500 == 0) REQUIRE(pipeline.accept(live(fired_packet(count, sclk_s, 1))).ok());
                if (i % 900 == 0) {
                    packet.back() ^= 1U;
                    REQUIRE(pipeline.accept(live(packet)).ok());
                    REQUIRE(pipeline.accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{5}, false, "blackout"})
                                .ok());
                }
            }
            pipeline.relay_progress(0.5);
            if (finished)
                REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok());
            else
                REQUIRE(pipeline.commit().ok());
            pipeline.abandon();
        }
    }

    /// Every derived row of every run, as SQL would write it.
    std::string derived_rows() const {
        auto database = std::move(sqlite::Database::open(file.string(), sqlite::Mode::read_only)).value();
        std::string all;
        for (const auto& table : archive::run_tables()) {
            if (!table.derived) continue;
            auto names = database.prepare(
                "SELECT group_concat('quote(' || name || ')', '||'',''||') FROM pragma_table_info(?1)");
            REQUIRE(names.ok());
            names->bind(1, std::string_view(table.name));
            REQUIRE(*names->step());
            auto rows = database.prepare(
                ("SELECT " + std::string(names->text(0)) + " AS row FROM " + table.name + " ORDER BY row").c_str());
            REQUIRE(rows.ok());
            while (*rows->step()) all.append(table.name).append(rows->text(0)).append("\n");
        }
        return all;
    }
    void spoil(const char* sql) const {
        auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
        REQUIRE(database->execute(sql).ok());
    }
    std::vector<std::string> faults() const {
        const auto found = pipeline::verify(file, {}, dictionary, nullptr, folder / "");
        REQUIRE(found.ok());
        for (const auto& note : found->notes)  // a rebuild is in the audit, whose last hash is told
            CHECK_THAT(note, Catch::StartsWith("audit: "));
        return found->faults;
    }
};

}  // namespace

TEST_CASE("everything derived is made again from the raw packets, identical", "[archive][rebuild][R43]") {
    const Recorded recorded;
    const auto before = recorded.derived_rows();
    REQUIRE(before.size() > 100'000);
    for (const char* table :
         {"segment_columns", "pyramid_columns", "events", "timepoint_firings", "alarms", "recordings", "packets"})
        REQUIRE(before.find(table) != std::string::npos);
    SECTION("as they are") {}
    SECTION("after damage to each of them") {
        recorded.spoil(
            "UPDATE events SET text = 'nothing happened'; DELETE FROM alarms; UPDATE segment_columns SET value = x'00';"
            "DELETE FROM segments WHERE run = 2; DELETE FROM pyramid; UPDATE pyramid_columns SET nodes = x'';"
            "UPDATE timepoint_firings SET fired_sclk = 0; UPDATE recordings SET realtime = 7; UPDATE packets SET "
            "standing = 0;"
            "UPDATE packets SET sampled = 0, packet = NULL WHERE key & 3 = 1");
    }
    const auto rebuilt = pipeline::rebuild(recorded.file, {}, recorded.dictionary, nullptr, {});
    REQUIRE(rebuilt.ok());
    CHECK(rebuilt->left.empty());
    CHECK(rebuilt->runs == std::vector<RunId>{RunId{1}, RunId{2}});
    CHECK((recorded.derived_rows() == before));  // in two brackets: it is long
    CHECK(recorded.faults().empty());
    CHECK_FALSE(std::filesystem::exists(recorded.folder / "a.db-rebuild"));
}

TEST_CASE("a rebuild that is stopped says how far it was, and leaves each run as it was or made again",
          "[archive][rebuild][R43]") {
    const Recorded recorded;
    const auto before = recorded.derived_rows();
    std::vector<std::uint32_t> seen;
    const auto rebuilt =
        pipeline::rebuild(recorded.file, {}, recorded.dictionary, nullptr, {}, [&](const pipeline::Progress& progress) {
            CHECK((progress.packets <= progress.of_packets && progress.of_packets > 0));
            seen.push_back(progress.run.value);
            return progress.run == RunId{1};
        });
    REQUIRE(rebuilt.ok());
    CHECK(rebuilt->stopped);
    CHECK(rebuilt->runs == std::vector<RunId>{RunId{1}});
    CHECK(seen.back() == 2);
    CHECK((recorded.derived_rows() == before));
    CHECK(recorded.faults().empty());
    CHECK_FALSE(std::filesystem::exists(recorded.folder / "a.db-rebuild"));
    const auto compared = pipeline::verify(recorded.file, {}, recorded.dictionary, nullptr, recorded.folder / "",
                                           [](const pipeline::Progress&) { return false; });
    REQUIRE(compared.ok());
    CHECK(compared->stopped);
}

TEST_CASE("verify names what is wrong, and finds nothing in a good archive", "[archive][verify]") {
    const Recorded recorded;
    CHECK(recorded.faults().empty());
    const auto only = [&](const char* sql) {
        recorded.spoil(sql);
        const auto faults = recorded.faults();
        INFO(sql);
        REQUIRE(faults.size() == 1);
        return faults.front();
    };
    SECTION("an event's text") {
        CHECK(
            only("UPDATE events SET text = 'all is well' WHERE key = (SELECT min(key) FROM events WHERE key > 2 << 40)")
                .find("run 2: events: item ") == 0);
    }
    SECTION("an alarm that is gone leaves a number that no item has") {
        recorded.spoil("DELETE FROM alarms WHERE key = (SELECT min(key) FROM alarms)");
        const auto faults = recorded.faults();
        REQUIRE(faults.size() == 2);
        CHECK(faults[0].find("run 1: no item has the number ") == 0);
        CHECK(faults[1].find("run 1: alarms: item ") == 0);
        CHECK(faults[1].find("is missing: a packet says it") != std::string::npos);
    }
    SECTION("a sample's octets") {
        CHECK(only("UPDATE segment_columns SET value = CAST(substr(value, 1, 60) || x'0102' || substr(value, 63) AS "
                   "BLOB) WHERE key = (8388608 + 1) * 65536")
                  .find("run 1: segment_columns: segment 8388609, channel altitude_m is damaged: ") == 0);
    }
    SECTION("samples that are whole but not those of the packets") {
        CHECK(only("UPDATE segment_columns SET value = (SELECT value FROM segment_columns WHERE key = 8388608 * 65536 "
                   "+ 1) WHERE key = 8388608 * 65536")
                  .find("run 1: segment_columns: segment 8388608, channel altitude_m its samples are not those of its "
                        "packets") == 0);
    }
    SECTION("a node of the pyramid") {
        CHECK(only("UPDATE pyramid_columns SET nodes = zeroblob(length(nodes)) WHERE key = 8388608 * 65536 + 1")
                  .find("run 1: pyramid_columns: block 8388608, channel speed_mps is not what its packet says") == 0);
    }
    SECTION("a raw packet") {
        recorded.spoil("UPDATE packets SET octets = CAST(substr(octets, 1, 20) || x'FF' || substr(octets, 22) AS BLOB) "
                       "WHERE key = (1 << 40) + 40");
        const auto faults = recorded.faults();
        CHECK_FALSE(faults.empty());  // its own row, and all that followed from it
    }
    SECTION("a word, by which other programs read a number") {
        CHECK(only("UPDATE words SET word = 'recorded' WHERE kind = 'source' AND number = 1") ==
              "words: source 1 is not \"realtime\"");
    }
    SECTION("a name of the dictionary") {
        CHECK(only("UPDATE dictionary_channels SET name = 'speed_mps' WHERE name = 'altitude_m'") ==
              "dictionary_channels: not what dictionary 4711 says");
    }
    SECTION("a packet more in the dictionary") {
        CHECK(only("INSERT INTO dictionary_packets VALUES (4711, 999, 'NoPacket', 7)") ==
              "dictionary_packets: not what dictionary 4711 says");
    }
    SECTION("a view, by which other programs read events") {
        CHECK(only("DROP VIEW event_log; CREATE VIEW event_log AS SELECT * FROM events") ==
              "view event_log: not as this program makes it");
    }
    SECTION("a trigger, which would change rows to come; a table of somebody's own is none of ours") {
        CHECK(
            only("CREATE TABLE mine (a); CREATE TRIGGER quiet AFTER INSERT ON events BEGIN DELETE FROM alarms; END") ==
            "trigger quiet: no part of an archive");
    }
    SECTION("the last number") {
        CHECK(only("UPDATE runs SET last_seq = last_seq + 5 WHERE run = 1").find("run 1: its last item should be ") ==
              0);
    }
}

TEST_CASE("a run that this program would tell otherwise is left as it is", "[archive][rebuild]") {
    const Recorded recorded;
    const auto before = recorded.derived_rows();
    SECTION("its dictionary is another") {
        auto other = recorded.dictionary;
        ++other.id;
        const auto rebuilt = pipeline::rebuild(recorded.file, RunId{1}, other, nullptr, {});
        REQUIRE(rebuilt.ok());
        REQUIRE(rebuilt->left.size() == 1);
        CHECK(rebuilt->left.front() == "run 1 was recorded with dictionary 4711, this program has 4712");
        const auto found = pipeline::verify(recorded.file, {}, other, nullptr, recorded.folder / "");
        CHECK(found->faults.empty());
        CHECK(std::ranges::count_if(found->notes, [](const auto& note) {
                  return note.find("its derived rows were not compared") != std::string::npos;
              }) == 2);
    }
    SECTION("items would get other numbers") {
        auto other = recorded.dictionary;
        other.channels[speed.value].type.alarms = {};
        const auto rebuilt = pipeline::rebuild(recorded.file, RunId{1}, other, nullptr, {});
        REQUIRE(rebuilt.ok());
        REQUIRE(rebuilt->left.size() == 1);
        CHECK(rebuilt->left.front().find("run 1: its packets now say something else") == 0);
    }
    CHECK((recorded.derived_rows() == before));
    CHECK(pipeline::rebuild(recorded.file, RunId{9}, recorded.dictionary, nullptr, {}).error().message == "no run 9");
}

TEST_CASE("an archive is not rebuilt while another writes it, and one that is not there is not made",
          "[archive][rebuild]") {
    const Recorded recorded;
    {
        const auto writer = Archive::open(recorded.file);
        REQUIRE(writer.ok());
        CHECK(pipeline::rebuild(recorded.file, {}, recorded.dictionary, nullptr, {})
                  .error()
                  .message.find("is being written by another process") != std::string::npos);
    }
    const auto none = recorded.folder / "none.db";
    CHECK(pipeline::rebuild(none, {}, recorded.dictionary, nullptr, {}).error().message ==
          none.string() + ": there is no such file");
    CHECK_FALSE(pipeline::verify(none, {}, recorded.dictionary, nullptr, recorded.folder / "").ok());
    CHECK_FALSE(std::filesystem::exists(none));
}

}  // namespace archive_derivation_test
