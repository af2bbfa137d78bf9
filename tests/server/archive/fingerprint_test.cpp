// SPDX-License-Identifier: Apache-2.0
// What is stored once and follows from nothing else: each edit of it by hand is found, and named.
#include "server/archive/archive.hpp"
#include "server/archive/fingerprint.hpp"
#include "server/archive/upkeep.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace archive_fingerprint_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace aeolis::archive;

namespace {

archive::NoteRecord note(std::string text) {
    return {{0, Ert{7}}, std::move(text), "Ada", "2026-11-22T12:00:00Z", {}, {}, {}, 0};
}

/// A run with a row in each table, over, and one that was cut off; with the head of the audit as it was then.
struct Flown {
    TemporaryFolder folder;
    std::filesystem::path file = folder / "a.db";
    dictionary::Dictionary dictionary = small_dictionary();
    AuditHead head;

    Flown() {
        record();
        REQUIRE(Archive::open(file).ok());  // marks the second run as cut off
    }
    void record() {
        auto archive = std::move(Archive::open(file)).value();
        pipeline::Pipeline pipeline(archive, dictionary);
        RunStart start;
        start.scenario = "nominal";
        start.seed = 9;
        start.solution = {{"latitude_deg", -4.5}};
        start.scenario_text = "name: \"nominal\"";
        REQUIRE(pipeline.begin(start).ok());
        REQUIRE(pipeline.accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{5}, true, "nominal"}).ok());
        for (std::uint16_t i = 0; i < 20; ++i)
            REQUIRE(pipeline.accept(live(navigation_packet(i, 1000.0 + i, 9000.0F, 5000.0F), i * 1'000'000)).ok());
        telemetry::ReceivedTone tone;
        tone.tone = ToneId{9};
        tone.best = {{{9, 0.9}, {1, 0.05}, {2, 0.03}, {3, 0.01}, {4, 0.01}}};
        REQUIRE(pipeline.accept(tone).ok());
        StageRecord stage;
        stage.command = 1;
        stage.name = "NO_OP";
        stage.evidence = "checked";
        REQUIRE(pipeline.accept(stage).ok());
        REQUIRE(pipeline.accept(RequestRecord{3, "command { command: \"NO_OP\" }"}).ok());
        REQUIRE(pipeline.annotate(RunId{1}, note("handed over")).ok());
        REQUIRE(pipeline
                    .annotate(RunId{1},
                              AlarmActionRecord{
                                  {0, Ert{9}}, "speed_mps", telemetry::AlarmAct::acknowledge, "seen", "Ada", {}})
                    .ok());
        REQUIRE(pipeline.accept(telemetry::EarthTime{Ert{60'000'000}}).ok());
        pipeline.link_totals({LinkTotals{"uhf_live", {}, 700.0}});
        REQUIRE(pipeline.finish({archive::Outcome::touchdown, "as planned", "abcd", "2026-11-22T12:10:00Z"}).ok());
        REQUIRE(pipeline.annotate(RunId{1}, note("written the day after")).ok());
        REQUIRE(pipeline.begin({}).ok());
        REQUIRE(pipeline.accept(live(navigation_packet(1, 1000.0, 9000.0F, 5000.0F))).ok());
        REQUIRE(pipeline.commit().ok());
        pipeline.abandon();
        head = archive.audit_head().value();
    }

    void edit(const std::string& sql) const {
        auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
        INFO(sql);
        REQUIRE(database->execute(sql.c_str()));
        REQUIRE(database->integer_of("SELECT changes()").value() > 0);
    }
    pipeline::Verification verified(const std::optional<AuditHead>& known = {}) const {
        auto found = pipeline::verify(file, {}, dictionary, nullptr, folder / "", {}, known);
        REQUIRE(found.ok());
        return std::move(*found);
    }
};

bool names(const std::vector<std::string>& faults, const std::string& what) {
    return std::ranges::any_of(faults, [&](const auto& fault) { return fault.find(what) == 0; });
}

}  // namespace

TEST_CASE("an archive as it was written has all its fingerprints; a run that was cut off is said to have none",
          "[archive][verify][fingerprint]") {
    const Flown flown;
    CHECK(flown.head.entry == 2);
    const auto found = flown.verified(flown.head);
    CHECK(found.faults == std::vector<std::string>{});
    REQUIRE(found.notes.size() == 2);
    CHECK_THAT(found.notes[1], Catch::StartsWith("audit: run 2 has no fingerprint (it was cut off)"));
}

TEST_CASE("whatever of a run is edited, taken out or added by hand, verify names the run and the table",
          "[archive][verify][fingerprint]") {
    struct Edit {
        const char *sql, *named;
    };
    const auto edit = GENERATE(values<Edit>(
        {{"UPDATE notes SET text = 'never handed over' WHERE text = 'handed over'", "run 1: notes: not what"},
         {"UPDATE notes SET text = 'never' WHERE text LIKE 'written%'", "run 1: notes: not what"},
         {"UPDATE notes SET author = 'Bob'", "run 1: notes: not what"},
         {"DELETE FROM notes", "run 1: notes: not what"},
         {"UPDATE alarm_actions SET note = ''", "run 1: alarm_actions: not what"},
         {"UPDATE tones SET likelihood = 0.1", "run 1: tones: not what"},
         {"DELETE FROM tones", "run 1: tones: not what"},
         {"UPDATE tone_likelihoods SET likelihood = 0.5 WHERE position = 3", "run 1: tone_likelihoods: not what"},
         {"DELETE FROM tone_likelihoods WHERE position = 4", "run 1: tone_likelihoods: not what"},
         {"UPDATE command_stages SET evidence = 'nothing'", "run 1: command_stages: not what"},
         {"DELETE FROM command_stages", "run 1: command_stages: not what"},
         {"UPDATE link_changes SET words = 'blackout'", "run 1: link_changes: not what"},
         {"UPDATE situation_entries SET sentence = 'all is well'", "run 1: situation_entries: not what"},
         {"UPDATE requests SET cycle = 4", "run 1: requests: not what"},
         {"DELETE FROM requests", "run 1: requests: not what"},
         {"UPDATE run_solution SET value = 0", "run 1: run_solution: not what"},
         {"DELETE FROM run_anchors WHERE run = 1 AND anchor = 1", "run 1: run_anchors: not what"},
         {"UPDATE link_totals SET frames = 9", "run 1: link_totals: not what"},
         {"UPDATE runs SET outcome = 'lost' WHERE run = 1", "run 1: runs.outcome: not what"},
         {"UPDATE runs SET outcome_reason = '' WHERE run = 1", "run 1: runs.outcome_reason: not what"},
         {"UPDATE runs SET seed = 10 WHERE run = 1", "run 1: runs.seed: not what"},
         {"UPDATE runs SET digest = 'abce' WHERE run = 1", "run 1: runs.digest: not what"},
         {"UPDATE runs SET scenario_text = '' WHERE run = 1", "run 1: runs.scenario_text: not what"},
         {"UPDATE runs SET started = '2026' WHERE run = 1", "run 1: runs: not what"},
         {"UPDATE packets SET ert_us = ert_us + 1 WHERE run = 1 AND sclk = 1003", "run 1: packets: not what"},
         {"UPDATE words SET word = 'x_band' WHERE kind = 'link' AND word = 'uhf_live'", "run 1: packets: not what"},
         {"INSERT INTO notes SELECT (SELECT max(key) FROM notes) + 1, ert_us, author, 'put in', written, sclk, call, "
          "position, reads_back FROM notes LIMIT 1",
          "run 1: items after "},
         {"DELETE FROM runs WHERE run = 1", "run 1: the audit has its fingerprint, and it is gone without a prune"},
         {"INSERT INTO pruned_runs SELECT run, scenario, seed, case_number, outcome, started, '' FROM runs WHERE run = "
          "1; DELETE FROM runs WHERE run = 1",
          "run 1: the audit has its fingerprint, and it is gone without a prune"},
         {"UPDATE audit SET detail = replace(detail, 'notes=1:', 'notes=2:')", "audit: entry 1 was changed"}}));
    const Flown flown;
    flown.edit(edit.sql);
    const auto found = flown.verified(flown.head);
    INFO(edit.sql);
    for (const auto& fault : found.faults) UNSCOPED_INFO(fault);
    CHECK(names(found.faults, edit.named));
}

TEST_CASE("a fingerprint that is appended to cover an edit does not replace the first",
          "[archive][verify][fingerprint]") {
    const Flown flown;
    auto database = sqlite::Database::open(flown.file.string(), sqlite::Mode::read_write_create);
    REQUIRE(database->execute("UPDATE runs SET outcome = 'lost' WHERE run = 1"));
    const auto last = static_cast<Sequence>(
        database->integer_of("SELECT max(key) & 0xFFFFFFFFFF FROM notes WHERE key >> 40 = 1").value());
    const auto forged = fingerprint(*database, RunId{1}, 1, last);
    REQUIRE(forged);
    REQUIRE(append_audit(*database, {&*forged, 1}));
    const auto found = flown.verified(flown.head);
    CHECK(names(found.faults, "run 1: the audit has another fingerprint of items that had one"));
    CHECK(names(found.faults, "run 1: runs.outcome: not what"));
}

TEST_CASE("a run without items that gets a note after its end has a fingerprint of each",
          "[archive][verify][fingerprint]") {
    const TemporaryFolder folder;
    const auto file = folder / "a.db";
    const auto dictionary = small_dictionary();
    {
        auto archive = std::move(Archive::open(file)).value();
        pipeline::Pipeline pipeline(archive, dictionary);
        REQUIRE(pipeline.begin({}).ok());
        REQUIRE(pipeline.finish({archive::Outcome::stopped, "", "", "2026-11-22T12:10:00Z"}).ok());
        REQUIRE(pipeline.annotate(RunId{1}, note("nothing came")).ok());
    }
    CHECK(pipeline::verify(file, {}, dictionary, nullptr, folder / "")->faults == std::vector<std::string>{});
}

TEST_CASE("an audit that was emptied, or whose end was cut off, is found by a head kept outside the archive",
          "[archive][verify][audit]") {
    const Flown flown;
    SECTION("emptied") {
        flown.edit("DELETE FROM audit");
        CHECK(flown.verified().faults ==
              std::vector<std::string>{"run 1: it has ended, and its fingerprint is not in the audit"});
        CHECK(names(flown.verified(flown.head).faults,
                    "audit: entry 2 was known to be there, and is gone: the audit is empty"));
    }
    SECTION("cut off") {
        flown.edit("DELETE FROM audit WHERE entry = 2");
        CHECK(names(flown.verified(flown.head).faults,
                    "audit: entry 2 was known to be there, and is gone: the last is 1"));
    }
    SECTION("made anew, with hashes that agree") {
        auto database = sqlite::Database::open(flown.file.string(), sqlite::Mode::read_write_create);
        REQUIRE(database->execute("DELETE FROM audit"));
        const std::vector<AuditRecord> forged(2, AuditRecord{"2026", "", "server", "log-in", "", "done"});
        REQUIRE(append_audit(*database, forged));
        CHECK(names(flown.verified(flown.head).faults, "audit: entry 2 is not the one that was known to be there"));
    }
    SECTION("longer than it was known to be: nothing is wrong") {
        auto archive = std::move(Archive::open(flown.file)).value();
        REQUIRE(archive.append_audit(std::vector{AuditRecord{"2026", "", "server", "log-in", "", "done"}}));
        CHECK(flown.verified(flown.head).faults == std::vector<std::string>{});
    }
}

TEST_CASE("a run that was pruned is not missed, and one that was rebuilt keeps its fingerprint",
          "[archive][verify][fingerprint][prune]") {
    const Flown flown;
    const auto rebuilt = pipeline::rebuild(flown.file, {}, flown.dictionary, nullptr, {});
    REQUIRE(rebuilt.ok());
    CHECK(rebuilt->runs.size() == 2);
    CHECK(flown.verified(flown.head).faults == std::vector<std::string>{});
    auto archive = Maintenance::open(flown.file);
    REQUIRE(archive.ok());
    REQUIRE(prune(*archive, {RunId{1}}, {}).ok());
    CHECK(flown.verified(flown.head).faults == std::vector<std::string>{});
}

TEST_CASE("the head of an audit is read back from its file and from text, and nothing else is taken for one",
          "[audit]") {
    const TemporaryFolder folder;
    const auto file = head_file("/var/a.db", folder / "");
    CHECK(file.filename() == "a.db-audit");
    CHECK(read_head(file)->has_value() == false);
    const AuditHead head{12, std::string(64, 'a')};
    REQUIRE(write_head(file, head));
    CHECK(**read_head(file) == head);
    CHECK((std::filesystem::status(file).permissions() & std::filesystem::perms::all) ==
          (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
    CHECK(head_from_text(text_of(head)) == head);
    for (const std::string& text :
         std::vector<std::string>{"", "12", "12:", "0:" + std::string(64, 'a'), "-1:" + std::string(64, 'a'),
                                  "12:" + std::string(63, 'a'), "12:" + std::string(64, 'A')})
        CHECK_FALSE(head_from_text(text));
}

}  // namespace archive_fingerprint_test
