// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"
#include "server/pipeline/derivation.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/reopened_ground.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>

#include <atomic>

namespace archive_annotated_run_test {

// Alarms, what was done about them, notes and the words of all in one archive: over restart, rebuild and a second
// flight.

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::Reader;
using archive::RunId;
using pipeline::Pipeline;

namespace {

constexpr RunId first_run{1};

archive::NoteRecord note(std::string text) {
    return {{0, Ert{7}}, std::move(text), "Ada", "2026-11-22T12:00:00Z", {}, {}, {}, 0};
}
archive::AlarmActionRecord action(std::string alarm, telemetry::AlarmAct what, std::int64_t at_s,
                                  std::int64_t until_s = 0) {
    return {{0, Ert{at_s * 1'000'000}}, std::move(alarm), what, "seen", "Ada", Ert{until_s * 1'000'000}};
}

dictionary::Dictionary mission() {
    auto dictionary = small_dictionary();
    dictionary.channels[speed.value].type.alarms.latches = true;
    return dictionary;
}

struct Ground : test::ReopenedGround {
    Ground() : ReopenedGround(mission()) {}
    /// Behind it stands what the ground makes of it: the situation.
    const v1::Staleness& newest_staleness() const {
        return std::find_if(published.rbegin(), published.rend(), [](const auto& item) { return item.has_staleness(); })
            ->staleness();
    }
    void begin() { REQUIRE(pipeline->begin({}).ok()); }
    void fly(std::uint16_t from, std::uint16_t to, float speed_mps) {
        for (std::uint16_t i = from; i < to; ++i)
            REQUIRE(
                pipeline
                    ->accept(live(navigation_packet(i, 1000.0 + i, 9000.0F, speed_mps), std::int64_t{i} * 1'000'000))
                    .ok());
    }
    archive::Sequence add(archive::Annotation annotation) {
        const auto added = pipeline->annotate(first_run, std::move(annotation));
        REQUIRE(added.ok());
        REQUIRE(pipeline->commit().ok());
        return std::visit([](const auto& record) { return record.seq; }, *added);
    }
    std::string stored() const {
        std::string text;
        const auto page = reader().items(first_run, 0, 1000);
        for (const auto& item : page->items) text += item.ShortDebugString() + "\n";
        return text;
    }
    std::string states(std::int64_t at_s) const {
        std::string text;
        const auto list = reader().alarm_states(first_run, Ert{at_s * 1'000'000});
        REQUIRE(list.ok());
        for (const auto& alarm : list->alarms())
            text += alarm.name() + " " + v1::StandingAlarm::State_Name(alarm.state()) + " " +
                    v1::Alarm::Severity_Name(alarm.severity()) + " by " + alarm.by() + "; ";
        return text;
    }
    void search_holds() const {
        auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
        CHECK(database->execute("INSERT INTO search (search, rank) VALUES ('integrity-check', 1)").ok());
    }
};

}  // namespace

TEST_CASE("what is done about an alarm is an item of the run, the same when read back, and decides how it stands",
          "[alarms][archive]") {
    Ground ground;
    ground.begin();
    ground.fly(0, 3, 6100.0F);
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(3) == "speed_mps unacknowledged warning by ; ");
    ground.add(action("speed_mps", telemetry::AlarmAct::acknowledge, 3));
    CHECK(ground.states(3) == "speed_mps acknowledged warning by Ada; ");
    ground.add(action("speed_mps", telemetry::AlarmAct::shelve, 4, 64));
    CHECK(ground.states(5) == "speed_mps shelved warning by Ada; ");
    CHECK(ground.states(64) == "speed_mps acknowledged warning by Ada; ");
    ground.fly(3, 5, 5000.0F);
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(64) == "speed_mps latched none by Ada; ");
    ground.add(action("speed_mps", telemetry::AlarmAct::reset, 65));
    CHECK(ground.states(65).empty());
    CHECK(ground.reader().may(first_run, "speed_mps", telemetry::AlarmAct::reset, Ert{}).error().message ==
          "alarm speed_mps is not latched: there is nothing to reset");
    std::string published;
    for (const auto& item : ground.published) published += item.ShortDebugString() + "\n";
    CHECK(published == ground.stored());
    const auto changes = ground.reader().alarms(first_run, 0, 3);
    CHECK(changes->changes_size() == 3);
    CHECK(ground.reader().alarms(first_run, changes->next_after(), 3)->changes_size() == 2);
}

TEST_CASE("a packet that does not come is an alarm under its own name, stored, and gone when it comes",
          "[alarms][staleness][archive]") {
    Ground ground;
    ground.begin();
    REQUIRE(ground.pipeline->accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{0}, true, "nominal"}).ok());
    ground.fly(0, 3, 100.0F);
    REQUIRE(ground.pipeline->accept(telemetry::EarthTime{Ert{6'000'000}}).ok());
    REQUIRE(ground.pipeline->accept(telemetry::EarthTime{Ert{8'000'000}}).ok());
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(8) == "Navigation unacknowledged warning by ; ");
    CHECK(ground.newest_staleness().packet() == "Navigation");
    CHECK(ground.newest_staleness().silent_s() == 6.0);
    ground.fly(9, 10, 100.0F);
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(9) == "Navigation returned none by ; ");
}

TEST_CASE("a link whose silence nothing explains is an alarm under its own name, with the reason; a silence that was "
          "predicted is none",
          "[alarms][silence][archive]") {
    Ground ground;
    ground.begin();
    const auto tell = [&](std::int64_t at_s, bool up, const char* reason, bool lost = false) {
        REQUIRE(ground.pipeline
                    ->accept(telemetry::LinkState{telemetry::x_band_link, Ert{at_s * 1'000'000}, up, reason, lost})
                    .ok());
        REQUIRE(ground.pipeline->commit().ok());
    };
    tell(0, true, "nominal");
    tell(10, false, "carrier too weak: the link's budget has it below what a lock needs");
    CHECK(ground.states(10).empty());
    CHECK(ground.reader().alarms(first_run, 0, 10)->changes_size() == 0);
    tell(20, false, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.states(20) == "x_band unacknowledged distress by ; ");
    const auto list = ground.reader().alarm_states(first_run, {});
    REQUIRE(list.ok());
    CHECK(list->alarms(0).kind() == v1::StandingAlarm::link);
    CHECK(list->alarms(0).reason() == "unexplained: nothing is predicted to silence it now");
    CHECK(ground.reader().links().value() == std::vector<std::string>{"uhf_live", "relay", "x_band"});
    ground.add(action("x_band", telemetry::AlarmAct::acknowledge, 21));
    tell(30, true, "nominal");
    CHECK(ground.states(30).empty());                                      // seen, and over
    CHECK(ground.reader().alarms(first_run, 0, 10)->changes_size() == 5);  // all of a link that was lost, and the act
    std::string published;
    for (const auto& item : ground.published) published += item.ShortDebugString() + "\n";
    CHECK(published == ground.stored());
}

TEST_CASE("a link that is lost leaves its packets' alarms standing and names itself in them; one that is down takes "
          "them away",
          "[alarms][staleness]") {
    Ground ground;
    ground.begin();
    const auto lose = [&](std::int64_t at_s, bool lost) {
        const std::string reason =
            lost ? "unexplained: nothing is predicted to silence it now" : "Earth set: predicted";
        REQUIRE(ground.pipeline
                    ->accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{at_s * 1'000'000}, false, reason, lost})
                    .ok());
        REQUIRE(ground.pipeline->commit().ok());
    };
    REQUIRE(ground.pipeline->accept(telemetry::LinkState{telemetry::uhf_live_link, Ert{0}, true, "nominal"}).ok());
    ground.fly(0, 3, 100.0F);
    lose(3, true);
    REQUIRE(ground.pipeline->accept(telemetry::EarthTime{Ert{8'000'000}}).ok());
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(8) == "uhf_live unacknowledged distress by ; Navigation unacknowledged warning by ; ");
    CHECK(ground.newest_staleness().reason() ==
          "the link is lost: unexplained: nothing is predicted to silence it now");
    lose(9, false);
    CHECK(ground.states(9) == "Navigation returned none by ; uhf_live returned none by ; ");
}

TEST_CASE("another mission's packets that cannot come are missed: its link does not go down for a reason",
          "[alarms][staleness][downlink]") {
    Ground ground;
    ground.begin();
    REQUIRE(ground.pipeline->accept(telemetry::LinkState{telemetry::downlink_link, Ert{0}, true, "connected"}).ok());
    ground.fly(0, 3, 100.0F);
    REQUIRE(ground.pipeline
                ->accept(telemetry::LinkState{telemetry::downlink_link, Ert{3'000'000}, false,
                                              "ground fault: connection refused", true})
                .ok());
    REQUIRE(ground.pipeline->accept(telemetry::EarthTime{Ert{8'000'000}}).ok());
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.states(8) == "downlink unacknowledged distress by ; Navigation unacknowledged warning by ; ");
    CHECK(ground.newest_staleness().reason() == "the link is lost: ground fault: connection refused");
}

TEST_CASE("states, notes and words survive a restart and a rebuild, and verify finds no fault",
          "[alarms][notes][rebuild]") {
    Ground ground;
    ground.begin();
    ground.fly(0, 3, 6100.0F);
    REQUIRE(ground.pipeline->accept(live(mortar_packet(0, 1003.0, 405.0F), 3'000'000)).ok());
    ground.add(note("the chute looks good"));
    ground.add(action("speed_mps", telemetry::AlarmAct::acknowledge, 3));
    REQUIRE(ground.pipeline->finish({archive::Outcome::touchdown, "", "", ""}).ok());
    const auto before = ground.stored();
    const auto state = ground.states(3);
    ground.open();
    CHECK(ground.stored() == before);
    CHECK(ground.states(3) == state);
    ground.pipeline.reset();
    ground.archive.reset();
    {
        auto database = archive::sqlite::Database::open(ground.file.string(), archive::sqlite::Mode::read_write_create);
        REQUIRE(database->execute("UPDATE events SET text = 'nothing'; DELETE FROM alarms").ok());
    }
    const auto rebuilt = pipeline::rebuild(ground.file, {}, ground.dictionary, nullptr, {});
    REQUIRE(rebuilt.ok());
    CHECK(rebuilt->left.empty());
    CHECK(ground.stored() == before);
    CHECK(ground.states(3) == state);
    CHECK(pipeline::verify(ground.file, {}, ground.dictionary, nullptr, ground.folder / "")->faults.empty());
    ground.search_holds();
    archive::EventQuery mortar;
    mortar.text = "mortar";
    CHECK(ground.reader().events(first_run, mortar)->events_size() == 1);
}

TEST_CASE("a note is added to a run that is over, after its last item, and those who follow it get it",
          "[notes][archive]") {
    Ground ground;
    ground.begin();
    ground.fly(0, 2, 100.0F);
    REQUIRE(ground.pipeline->finish({archive::Outcome::touchdown, "", "", ""}).ok());
    const auto last = *ground.reader().last_seq(first_run);
    CHECK(ground.add(note("a good landing")) == last + 1);
    CHECK(ground.published.back().note().text() == "a good landing");
    CHECK(ground.reader().run(first_run)->last_seq() == last + 1);
    CHECK(ground.pipeline->annotate(RunId{9}, note("nowhere")).error().message == "run 9: there is none that is over");
    CHECK(pipeline::verify(ground.file, {}, ground.dictionary, nullptr, ground.folder / "")->faults.empty());
}

TEST_CASE("a run that is flown again keeps what people added, at its place, and goes on after it",
          "[notes][alarms][resume]") {
    Ground ground;
    ground.begin();
    ground.add(note("before anything"));
    ground.fly(0, 3, 6100.0F);
    ground.add(action("speed_mps", telemetry::AlarmAct::acknowledge, 3));
    ground.fly(3, 4, 6100.0F);
    REQUIRE(ground.pipeline->commit().ok());
    const bool after_the_crash = GENERATE(false, true);
    ground.open();  // cut off
    if (after_the_crash) ground.add(note("it was cut off here"));
    const auto before = ground.stored();

    const auto cut = ground.reader().cut_off(first_run);
    REQUIRE(cut.ok());
    CHECK(cut->annotations.size() == (after_the_crash ? 3 : 2));
    std::size_t compared = 0;
    const auto compare = [&](const pipeline::PublishedBatch& again) -> Result<void> {
        for (const auto& item : again.items) compared += item.item_case() == v1::Item::ITEM_NOT_SET ? 0 : 1;
        return {};
    };
    REQUIRE(ground.pipeline->resume(first_run, {}, cut->last_seq, compare, cut->annotations).ok());
    CHECK(ground.pipeline->annotate(first_run, note("too early")).error().message ==
          "run 1 is flown again up to where it was cut off: try again when it goes on");
    ground.fly(0, 4, 6100.0F);
    const auto caught_up = ground.pipeline->caught_up();
    REQUIRE(caught_up.ok());
    CHECK(*caught_up);
    CHECK(compared == 9);  // four packets, their samples, one alarm
    CHECK(ground.stored() == before);
    ground.add(note("and on"));
    ground.fly(4, 5, 6100.0F);
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.stored().starts_with(before));
    const auto page = ground.reader().items(first_run, 0, 1000);
    for (std::size_t i = 0; i < page->items.size(); ++i) CHECK(page->items[i].seq() == i + 1);
}

TEST_CASE("plain words find events, explanations, commands and notes, whatever signs people type",
          "[search][archive]") {
    Ground ground;
    ground.begin();
    REQUIRE(ground.pipeline->accept(live(mortar_packet(0, 1003.0, 405.0F), 3'000'000)).ok());
    archive::StageRecord stage;
    stage.command = 4;
    stage.name = "EDL_SET_PARAMETERS";
    stage.stage = commands::Stage::released;
    stage.evidence = "left the station";
    REQUIRE(ground.pipeline->accept(stage).ok());
    ground.add(note("the chute's load: 5.3 g"));
    auto reader = ground.reader();
    const auto events = [&](const char* text) {
        archive::EventQuery query;
        query.text = text;
        const auto found = reader.events(first_run, query);
        REQUIRE(found.ok());
        return found->events_size();
    };
    CHECK(events("mortar") == 1);
    CHECK(events("MORT 405") == 1);
    CHECK(events("parachute_deploy") == 1);
    CHECK(events("mortar chute") == 0);
    CHECK(events("ortar") == 0);  // words, and their beginnings
    for (const char* signs : {"\"mortar", "mortar*", "(mortar", "mortar)", "mortar -", "NEAR(mortar", "text:mortar^2",
                              "mortar;--", "'mortar'"}) {
        INFO(signs);
        CHECK_NOTHROW(events(signs));
    }
    CHECK(events("\"mortar* (-fired)\"") == 1);
    CHECK(events("--- \"\" **") == 0);
    CHECK(events("AND") == 0);
    CHECK(reader.notes(first_run, {"load 5.3", 0, 10})->notes_size() == 1);
    CHECK(reader.notes(first_run, {"ada", 0, 10})->notes_size() == 1);
    CHECK(reader.notes(first_run, {"mortar", 0, 10})->notes_size() == 0);
    CHECK(reader.commands(first_run, {{}, "set station"})->commands_size() == 1);
    CHECK(reader.commands(first_run, {{}, "abort"})->commands_size() == 0);
    archive::ExplanationQuery why;
    why.text = "mortar";
    CHECK(reader.explanations(first_run, why)->explanations_size() == 0);
    ground.search_holds();
}

TEST_CASE("a formula gives exact values at its first channel's times, and thinned ones keep the extremes",
          "[expression][reader]") {
    Ground ground;
    ground.begin();
    for (std::uint16_t i = 0; i < 1000; ++i) {
        std::optional<float> altitude_m;
        if (i != 500) altitude_m = static_cast<float>(1000 - i);
        REQUIRE(
            ground.pipeline->accept(live(navigation_packet(i, 1000.0 + i / 64.0, altitude_m, static_cast<float>(i)), i))
                .ok());
        if (i % 64 == 32)
            REQUIRE(ground.pipeline
                        ->accept(live(status_packet(i / 64, 1000.0 + i / 64.0, static_cast<std::uint8_t>(i / 64)), i))
                        .ok());
    }
    REQUIRE(ground.pipeline->commit().ok());
    auto reader = ground.reader();
    const auto sum = reader.derived(first_run, "speed_mps + {GNC-0001}", {}, {});
    REQUIRE(sum.ok());
    CHECK(sum->sclk_size() == 1000);  // where the altitude is undefined, the one before counts
    CHECK(sum->value(0) == 1000.0);
    CHECK(sum->value(999) == 1000.0);
    CHECK(sum->name() == "speed_mps + {GNC-0001}");
    const auto held = reader.derived(first_run, "speed_mps*0 + edl_phase", {1000.5, 1002.0}, {});
    REQUIRE(held.ok());
    CHECK(held->sclk_size() == 97);
    CHECK(held->value(0) == 0.0);
    CHECK(held->value(96) == 1.0);
    const auto thin = reader.derived(first_run, "abs(speed_mps - 700.5)", {}, 20);
    REQUIRE(thin.ok());
    CHECK(thin->thinned());
    CHECK(thin->samples() == 1000);
    CHECK(thin->sclk_size() <= 20);
    CHECK(*std::ranges::max_element(thin->value()) == 700.5);
    CHECK(*std::ranges::min_element(thin->value()) == 0.5);
    CHECK(std::ranges::is_sorted(thin->sclk()));
    CHECK(reader.derived(first_run, "speed_mps + moon", {}, {}).error().message == "no channel 'moon'");
    const auto undefined = reader.derived(first_run, "sqrt(-speed_mps-1)", {}, {});
    CHECK(undefined->samples() == 0);
    CHECK(std::ranges::all_of(undefined->value(), [](double value) { return std::isnan(value); }));
}

TEST_CASE("a question ends soon after it shall stop, says so, and the next one is answered", "[reader][bounds]") {
    Ground ground;
    ground.begin();
    ground.fly(0, 3000, 100.0F);
    REQUIRE(ground.pipeline->commit().ok());
    auto reader = ground.reader();
    int looks = 0;
    reader.stop_when([&] { return ++looks > 3; });
    const auto proof = reader.proof(first_run);
    CHECK_FALSE(proof.ok());
    CHECK_THAT(proof.error().message, Catch::Contains("interrupted"));
    CHECK(reader.stopped());
    CHECK(looks < 100);
    reader.stop_when({});
    CHECK_FALSE(reader.stopped());
    CHECK(reader.proof(first_run).ok());
}

}  // namespace archive_annotated_run_test
