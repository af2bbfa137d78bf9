// SPDX-License-Identifier: Apache-2.0
// What the ground says at every second of whole landings, held against what was flown. The test reads the truth; the
// ground does not.
#include "server/pipeline/pipeline.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/packet_stream.hpp"
#include "telemetry/situation_monitor.hpp"
#include "telemetry/text.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace server_situation_landing_test {

using namespace aeolis;
using namespace aeolis::server;
using v1::SituationEntry;

namespace {

constexpr std::int64_t second_us = 1'000'000;

constexpr std::array<const char*, 12> scenarios{
    "nominal_auto",   "second_chance", "od137",   "tones_only",  "relay_passes",       "campaign",
    "bench_wideband", "all_but_gnc",   "nominal", "two_persons", "nominal_light_time", "pre_edl"};

/// A landing as ground told it, second by second, and as it was.
struct Told {
    struct Second {
        Ert now;
        v1::Situation situation;
        archive::Sequence seq = 0;  ///< of the item
    };
    std::vector<Second> seconds;
    std::vector<v1::Item> items;
    std::map<std::string, std::vector<Ert>> live;    ///< packets in real time, ascending, by link
    std::map<std::string, archive::Sequence> heard;  ///< first item of each timepoint in real time, in words
    archive::Sequence begun = std::numeric_limits<archive::Sequence>::max();  ///< first item that says so
    std::map<std::string, double, std::less<>> events;                        ///< truth, by name: SCLK of the first
    std::map<std::string, double, std::less<>> firings;  ///< truth, by name in words: SCLK of the first
    archive::RunStart start;
    archive::Outcome outcome{};
    Ert seen(double sclk_s) const {
        return {start.correlation.scet_of(Sclk{sclk_s}).microseconds +
                static_cast<std::int64_t>(start.light_time_s * 1e6)};
    }
};

/// The events and firings in the recording, which no link has touched.
void read_truth(const Rehearsal& rehearsal, Told& told) {
    const auto& dictionary = tests::shipped_dictionary();
    telemetry::Decommutator decommutator{dictionary};
    telemetry::Decoded decoded;
    telemetry::PacketStream recording{rehearsal.landing().recording()};
    while (const auto packet = recording.next()) {
        if (decommutator.decode(*packet, decoded)) continue;
        if (const auto* event = telemetry::event_of(dictionary, decoded))
            told.events.try_emplace(event->name, decoded.header.time.seconds);
    }
    for (const auto& firing : rehearsal.firings())
        told.firings.try_emplace(telemetry::in_words(firing.name), firing.triggered_sclk);
}

Told fly(const simulation::Scenario& scenario, std::uint64_t seed) {
    test::TemporaryFolder folder;
    auto archive = std::move(archive::Archive::open(folder / "a.db")).value();
    pipeline::Pipeline pipeline{archive, tests::shipped_dictionary()};
    Rehearsal rehearsal{scenario, seed, 0, tests::shipped_dictionary()};
    Told told;
    told.start = rehearsal.run_start(0.0);
    pipeline.on_publish([&](const auto& batch) {
        for (const auto& item : batch->items)
            if (!item.has_samples() && !item.has_unit() && !item.has_explanation()) told.items.push_back(item);
    });
    REQUIRE(pipeline.begin(told.start).ok());
    std::vector<Ert> ticks;
    bool taken = true;
    const auto take = [&](Result<void> done) { taken = taken && done.ok(); };
    while (!rehearsal.finished()) {
        const auto& received = rehearsal.step();
        for (const auto& packet : received.packets)
            if (telemetry::is_live_telemetry(packet.link.name)) told.live[packet.link.name].push_back(packet.ert);
        take(pipeline.accept(received));
        for (auto& stage : rehearsal.take_stages()) take(pipeline.accept(std::move(stage)));
        if (rehearsal.cycles() % 64 == 0) {
            take(pipeline.accept(telemetry::EarthTime{rehearsal.landing().ert_now()}));
            ticks.push_back(rehearsal.landing().ert_now());
        }
        take(pipeline.commit_if_full());
    }
    REQUIRE(taken);
    told.outcome = rehearsal.outcome();
    REQUIRE(pipeline.finish({}).ok());
    for (auto& [link, erts] : told.live) std::ranges::sort(erts, {}, &Ert::microseconds);
    for (const auto& item : told.items) {
        if (item.has_timepoint() && item.timepoint().source() == v1::SOURCE_REALTIME)
            told.heard.try_emplace(telemetry::in_words(item.timepoint().name()), item.seq());
        if (item.has_event() && item.event().name() == "EDL_BEGUN") told.begun = std::min(told.begun, item.seq());
    }
    const v1::Item* last = nullptr;
    auto item = told.items.begin();
    for (const Ert tick : ticks) {
        for (; item != told.items.end() && !(item->has_situation() && item->ert_us() > tick.microseconds); ++item)
            if (item->has_situation()) last = &*item;
        if (last != nullptr) told.seconds.push_back({tick, last->situation(), last->seq()});
    }
    read_truth(rehearsal, told);
    return told;
}

bool has(const v1::Situation& situation, const std::string& subject) {
    return std::ranges::any_of(situation.entries(), [&](const auto& entry) { return entry.subject() == subject; });
}
const SituationEntry* find(const v1::Situation& situation, const std::string& subject) {
    const auto found = std::ranges::find(situation.entries(), subject, &SituationEntry::subject);
    return found == situation.entries().end() ? nullptr : &*found;
}

/// The list itself: ranked, bounded, in words.
void check_list(const v1::Situation& situation) {
    REQUIRE_FALSE(situation.entries().empty());
    CHECK(situation.entries_size() <= static_cast<int>(telemetry::SituationMonitor::entries_max));
    CHECK(situation.entries(0).rank() >= SituationEntry::calm);
    for (int i = 0; i + 1 < situation.entries_size(); ++i)
        CHECK(situation.entries(i).rank() >= situation.entries(i + 1).rank());
    for (const auto& entry : situation.entries()) {
        CHECK_FALSE(entry.sentence().empty());
        CHECK(entry.awaited().empty() != entry.has_at_us());
    }
}

/// Countdowns count to what is to come; what is past is overdue.
void check_countdowns(const Told::Second& at) {
    const auto late_us = static_cast<std::int64_t>(telemetry::SituationMonitor::tone_late_s * 1e6) + second_us;
    for (const auto& entry : at.situation.entries()) {
        if (!entry.has_at_us()) continue;
        CAPTURE(entry.sentence(), entry.awaited(), entry.at_us() - at.now.microseconds, entry.overdue());
        if (entry.overdue())
            CHECK(entry.at_us() < at.now.microseconds);
        else
            CHECK(entry.at_us() >= at.now.microseconds - late_us);
    }
}

/// Who is silent brings nothing.
void check_silences(const Told& told, const Told::Second& at, const Told::Second* before) {
    const auto brought_by = [&](const std::string& link, std::int64_t after_us) {
        const auto live = told.live.find(link);
        if (live == told.live.end()) return false;
        const auto first = std::ranges::upper_bound(live->second, after_us, {}, &Ert::microseconds);
        return first != live->second.end() && first->microseconds <= at.now.microseconds;
    };
    if (before == nullptr) return;
    const std::int64_t last_second = before->now.microseconds;
    for (const auto* name : {"uhf_live", "x_band_telemetry"})
        if (const auto* link = find(at.situation, name)) {
            CAPTURE(link->sentence());
            // The last packet of a lock comes with the end of the lock.
            CHECK_FALSE(brought_by(name, std::max(last_second, link->since_us() + second_us)));
        }
    if (const auto* vehicle = find(at.situation, "vehicle")) {
        CAPTURE(vehicle->sentence());
        for (const auto* name : {"uhf_live", "x_band_telemetry"})
            CHECK_FALSE(brought_by(name, std::max(last_second, vehicle->since_us() + second_us)));
    }
}

/// Nothing is said to have happened before word of it could be here, and of each step only what the recording has.
void check_steps(const Told& told, const Told::Second& at) {
    const auto here = [&](double sclk_s) { return told.seen(sclk_s) <= at.now; };
    if (const auto* landed = find(at.situation, "landed")) {
        CAPTURE(landed->sentence());
        REQUIRE(told.events.contains("TOUCHDOWN"));
        CHECK(here(told.events.at("TOUCHDOWN")));
        const double late_s =
            static_cast<double>(landed->since_us() - told.seen(told.events.at("TOUCHDOWN")).microseconds) * 1e-6;
        CHECK(late_s > -0.5);
        CHECK(late_s < (landed->sentence().ends_with("by tone") ? 20.0 : 0.5));
        CHECK_FALSE(has(at.situation, "vehicle"));
    }
    if (const auto* computer = find(at.situation, "computer")) {
        CAPTURE(computer->sentence());
        REQUIRE(told.events.contains("SECOND_CHANCE_TAKES_OVER"));
        CHECK(here(told.events.at("SECOND_CHANCE_TAKES_OVER")));
    }
    for (const auto& entry : at.situation.entries()) {
        const std::string last =
            entry.evidence().starts_with("last heard by tone: ") ? "last heard by tone: " : "last heard: ";
        if (!entry.evidence().starts_with(last)) continue;
        CAPTURE(entry.evidence());
        const auto name = entry.evidence().substr(last.size(), entry.evidence().find(',') - last.size());
        const auto flown = told.firings.find(name);
        REQUIRE(flown != told.firings.end());
        CHECK(here(flown->second));
    }
    if (const auto* step = find(at.situation, "step")) {
        CAPTURE(step->sentence());
        const std::string waiting = step->sentence().starts_with("Next: ") ? "Next: " : "Waiting for ";
        REQUIRE(step->sentence().starts_with(waiting));
        const auto name =
            step->sentence().substr(waiting.size(), step->sentence().find_first_of(",;") - waiting.size());
        const auto heard = told.heard.find(name);
        CHECK((heard == told.heard.end() || heard->second >= at.seq));
    }
    if (has(at.situation, "begin")) CHECK(told.begun >= at.seq);
}

void check_all(const Told& told) {
    REQUIRE(told.seconds.size() > 60);
    const Told::Second* before = nullptr;
    for (const auto& at : told.seconds) {
        CAPTURE(static_cast<double>(at.now.microseconds - told.seen(told.start.entry.seconds).microseconds) * 1e-6,
                at.situation.ShortDebugString());
        check_list(at.situation);
        check_countdowns(at);
        check_silences(told, at, before);
        check_steps(told, at);
        before = &at;
    }
}

Told check_landing(const char* name, std::uint64_t seed) {
    CAPTURE(name, seed);
    auto told = fly(test::shipped_scenario(name), seed);
    check_all(told);
    return told;
}

const SituationEntry* at_e_s(const Told& told, double e_s, const std::string& subject) {
    const Ert then = told.seen(told.start.entry.seconds + e_s);
    const auto found = std::ranges::find_if(told.seconds, [&](const auto& second) { return second.now >= then; });
    REQUIRE(found != told.seconds.end());
    return find(found->situation, subject);
}

/// The times at which something new calls for the operator, in microseconds of ERT: an alarm that is raised or grows, a
/// link that is lost, a packet that is missing. Consequences that the ground names as such are one line with their
/// cause, as in the console.
std::vector<std::int64_t> calls_of(const Told& told) {
    std::vector<std::int64_t> calls;
    std::map<std::uint32_t, v1::Alarm::Severity> severity;
    std::set<std::string> lost;
    for (const auto& item : told.items) {
        if (item.has_alarm()) {
            auto& before = severity.try_emplace(item.alarm().channel(), v1::Alarm::none).first->second;
            if (item.alarm().severity() > before) calls.push_back(item.ert_us());
            before = item.alarm().severity();
        } else if (item.has_staleness()) {
            if (item.staleness().missing() && !item.staleness().reason().starts_with("the link is lost"))
                calls.push_back(item.ert_us());
        } else if (item.has_link()) {
            if (!item.link().lost())
                lost.erase(item.link().link());
            else if (lost.insert(item.link().link()).second)
                calls.push_back(item.ert_us());
        }
    }
    return calls;
}

/// The most calls within ten minutes.
std::ptrdiff_t most_in_ten_minutes(const std::vector<std::int64_t>& calls) {
    constexpr std::int64_t ten_minutes_us = 600 * second_us;
    std::ptrdiff_t most = 0;
    for (const auto from : calls)
        most = std::max(most, std::ranges::count_if(
                                  calls, [&](std::int64_t at) { return at >= from && at < from + ten_minutes_us; }));
    return most;
}

constexpr std::ptrdiff_t flood = 10;  ///< alarms in ten minutes that one operator can still take [isa-18.2]

}  // namespace

TEST_CASE("nothing that the situation says over a landing is false, and a landing without a fault has no news of one",
          "[situation][server]") {
    const auto told = check_landing("nominal_auto", 1);
    REQUIRE(told.outcome == archive::Outcome::touchdown);
    CHECK(calls_of(told).empty());
    for (const double e_s : {-1100.0, -810.0, -760.0, -740.0})
        for (const char* link : {"uhf_live", "x_band", "x_band_telemetry"}) CHECK(at_e_s(told, e_s, link) == nullptr);
    const auto* blackout = at_e_s(told, 75.0, "uhf_live");
    REQUIRE(blackout != nullptr);
    CHECK(blackout->rank() == SituationEntry::silence);
    CHECK_THAT(blackout->sentence(), Catch::StartsWith("UHF silent within the predicted plasma blackout, from E+0:4"));
    CHECK(blackout->awaited() == "UHF back");
    for (const auto& at : told.seconds)
        for (const auto& entry : at.situation.entries()) {
            CAPTURE(entry.sentence());
            CHECK(entry.rank() != SituationEntry::danger);
            const auto known = std::set<std::string>{"landed", "commanding", "recording"};
            if (entry.rank() == SituationEntry::news) CHECK(known.contains(entry.subject()));
        }
    CHECK_THAT(find(told.seconds.back().situation, "landed")->sentence(),
               Catch::StartsWith("Touchdown confirmed, at E+7:"));
    CHECK(find(told.seconds.back().situation, "landed")->rank() == SituationEntry::lasting);
    const auto& first = told.seconds.back().situation.entries(0);
    CHECK(first.sentence() == "The recording is complete");
    CHECK(first.rank() == SituationEntry::news);
}

TEST_CASE("when the prime computer fails, the situation says which computer flies, and since when",
          "[situation][server]") {
    const auto told = check_landing("second_chance", 1);
    const auto calls = most_in_ten_minutes(calls_of(told));
    CHECK(calls > 0);
    CHECK(calls <= flood);  // of one fault
    const auto* computer = at_e_s(told, 200.0, "computer");
    REQUIRE(computer != nullptr);
    CHECK(computer->sentence() == "Flying on backup computer B since E+1:40: it took over the timeline");
    CHECK(computer->rank() == SituationEntry::danger);
    CHECK(at_e_s(told, 95.0, "computer") == nullptr);
    const auto& last = told.seconds.back().situation;
    CHECK(std::ranges::count(last.entries(), "computer", &SituationEntry::subject) ==
          2);  // news, and a state that lasts
}

TEST_CASE("where only tones are heard, the situation says since when nothing is, what was predicted, and when the next "
          "word comes",
          "[situation][server]") {
    const auto told = check_landing("tones_only", 1);
    const auto* vehicle = at_e_s(told, 3600.0, "vehicle");
    REQUIRE(vehicle != nullptr);
    CHECK_THAT(vehicle->sentence(),
               Catch::StartsWith("Not heard since E+4:") &&
                   Catch::EndsWith("; landing was predicted at E+7:11; next word when Odyssey rises at E+2:00:00"));
    CHECK(vehicle->awaited() == "next word");
    CHECK_FALSE(vehicle->overdue());
    CHECK(at_e_s(told, 3600.0, "step") == nullptr);
    CHECK_THAT(find(told.seconds.back().situation, "landed")->sentence(), Catch::EndsWith("by the recording"));
}

TEST_CASE("over passes of orbiters nothing that the situation says is false", "[situation][server]") {
    check_landing("relay_passes", 2);
}

TEST_CASE("no prediction excuses a transmitter that failed before it, or a station that is out within it",
          "[situation][server][faults]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    auto& fault = scenario.device_faults.emplace_back();
    fault.device = flight::Device::uhf;
    fault.unit = flight::Unit::a;
    fault.kind = simulation::DeviceFault::Kind::dropout;
    fault.begin_before_entry_s = 20.0;  // fails before blackout, and comes back within what is predicted
    fault.duration_s = 100.0;
    scenario.station_outages = {{-300.0, 20.0}};
    const auto told = fly(scenario, 3);
    check_all(told);
    CHECK(most_in_ten_minutes(calls_of(told)) <= flood);  // of two
    for (const double e_s : {-10.0, 20.0, 60.0}) {
        const auto* uhf = at_e_s(told, e_s, "uhf_live");
        CAPTURE(e_s);
        REQUIRE(uhf != nullptr);
        CAPTURE(uhf->sentence());
        CHECK(uhf->rank() == SituationEntry::news);
        CHECK_THAT(uhf->sentence(), Catch::StartsWith("UHF lost since E−0:"));
        CHECK(uhf->awaited().empty());
    }
    const auto* station = at_e_s(told, 310.0, "station");
    REQUIRE(station != nullptr);
    CHECK(station->rank() == SituationEntry::news);
    CHECK(at_e_s(told, 340.0, "station") == nullptr);
    CHECK_THAT(find(told.seconds.back().situation, "loss of station")->sentence(),
               Catch::StartsWith("Station was lost from E+5:0"));
}

TEST_CASE("each scenario that flies the timeline by itself is in the list of those that are flown a hundred times",
          "[situation][server]") {
    std::set<std::string> flown{scenarios.begin(), scenarios.end()};
    for (const auto& file : std::filesystem::directory_iterator{test::shipped_scenarios}) {
        const auto name = file.path().stem().string();
        // GNC alone sends no telemetry; the threaded executive flies by the clock of the machine.
        const auto venue = test::shipped_scenario(name.c_str()).test_venue;
        const bool here = venue != simulation::TestVenue::gnc_alone && venue != simulation::TestVenue::performance;
        CAPTURE(name);
        CHECK(flown.contains(name) == here);
    }
}

// A test for each scenario, so that they are flown on all processors.
TEMPLATE_TEST_CASE_SIG("nothing that the situation says over 100 landings of a scenario is false",
                       "[.long][situation][server]", ((std::size_t Scenario), Scenario), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9,
                       10, 11) {
    static_assert(scenarios.size() == 12);
    for (std::uint64_t seed = 1; seed <= 100; ++seed) check_landing(scenarios[Scenario], seed);
}

}  // namespace server_situation_landing_test
