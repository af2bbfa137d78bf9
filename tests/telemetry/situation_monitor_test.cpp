// SPDX-License-Identifier: Apache-2.0
#include "telemetry/situation_monitor.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/silent_link.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace telemetry_situation_monitor_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using Rank = SituationRank;

namespace {

constexpr Sclk entry{1000.0};
Ert at(double e_s) {
    return {static_cast<std::int64_t>(e_s * 1e6) + 1'000'000'000};
}
Sclk sclk(double e_s) {
    return entry + e_s;
}

SituationMonitor monitor_at(double light_time_s) {
    SituationMonitor::Clocks clocks;
    clocks.entry = entry;
    clocks.correlation = {entry, Scet{1'000'000'000}};
    clocks.light_time_s = light_time_s;
    return {tests::shipped_dictionary(), clocks};
}

/// A monitor whose facts are given by seconds from entry.
struct Ground {
    SituationMonitor monitor = monitor_at(0.0);
    std::uint64_t seq = 0;

    SituationMonitor::Origin from(double e_s, bool recorded = false) { return {++seq, at(e_s), recorded}; }
    void up(const Link& link, double e_s) { monitor.link({link, at(e_s), true, "nominal"}, from(e_s)); }
    void down(const Link& link, double e_s, const std::string& reason, bool lost = false,
              std::optional<double> until_e_s = {}) {
        monitor.link(
            tests::silent_link(link, at(e_s), reason, lost, until_e_s ? std::optional(at(*until_e_s)) : std::nullopt),
            from(e_s));
    }
    void event(const std::string& name, double e_s, const std::string& text = "said so", bool recorded = false) {
        const auto* known = tests::shipped_dictionary().event(name);
        REQUIRE(known != nullptr);
        monitor.event({name, text, known->level, sclk(e_s)}, from(e_s, recorded));
    }
    void fired(const std::string& name, double e_s) {
        const auto& timeline = tests::shipped_dictionary().timeline;
        const auto row = std::ranges::find(timeline, name, &dictionary::TimelineRow::name);
        monitor.heard(sclk(e_s));
        monitor.fired(row->id, sclk(e_s), sclk(e_s), from(e_s));
    }
    void tone(const std::string& name, double e_s, double likelihood = 0.999) {
        const auto& tones = tests::shipped_dictionary().tones;
        const auto row = std::ranges::find(tones, name, &dictionary::ToneRow::name);
        REQUIRE(row != tones.end());
        monitor.tone(row->id, likelihood, sclk(e_s), from(e_s + 10.0));
    }
    SituationEntry first(double e_s) const { return monitor.at(at(e_s)).front(); }
    std::string sentence(double e_s) const { return first(e_s).sentence; }
    std::optional<SituationEntry> about(const std::string& subject, double e_s) const {
        const auto all = monitor.at(at(e_s));
        const auto found = std::ranges::find(all, subject, &SituationEntry::subject);
        return found == all.end() ? std::nullopt : std::optional(*found);
    }
};

}  // namespace

TEST_CASE("every name of the mission in the situation's rules is a word of the shipped dictionary", "[situation]") {
    const auto& dictionary = tests::shipped_dictionary();
    std::set<std::string_view> words;
    for (const auto& event : dictionary.events) words.insert(event.name);
    for (const auto& command : dictionary.commands) words.insert(command.name);
    for (const auto& tone : dictionary.tones) words.insert(tone.name);
    for (const auto& row : dictionary.timeline) words.insert(row.name);
    for (const auto& channel : dictionary.channels) words.insert(channel.name);
    for (const auto name : SituationMonitor::mission_names()) {
        CAPTURE(name);
        CHECK(words.contains(name));
    }
}

TEST_CASE("a silence as predicted says when the link is back, and when it is overdue", "[situation]") {
    Ground ground;
    ground.up(x_band_link, -100.0);
    ground.up(uhf_live_link, -100.0);
    ground.fired("entry_guidance", 43.0);
    ground.down(uhf_live_link, 50.0, "plasma blackout: predicted from E+0:45 to E+1:38", false, 98.0);
    const auto silent = ground.first(75.0);
    CHECK(silent.rank == Rank::silence);
    CHECK(silent.sentence ==
          "UHF silent within the predicted plasma blackout, from E+0:45 to E+1:38; X-band is received");
    CHECK(silent.awaited == "UHF back");
    CHECK(silent.at == at(98.0));
    CHECK_FALSE(silent.overdue);
    CHECK(ground.first(99.0).overdue);
    // It outlasts what was predicted.
    ground.down(uhf_live_link, 134.0, "unexplained: nothing is predicted to silence it now", true);
    const auto late = ground.first(135.0);
    CHECK(late.rank == Rank::news);
    CHECK(late.sentence == "UHF silent since E+0:50, longer than predicted (plasma blackout until E+1:38)");
    CHECK(late.overdue);
    ground.up(uhf_live_link, 140.0);
    CHECK(ground.first(140.0).rank == Rank::waiting);
}

TEST_CASE("UHF and tones that the plan has yet to switch on are not said to be silent, and are missed when overdue",
          "[situation]") {
    Ground ground;
    ground.up(x_band_telemetry_link, -1200.0);
    ground.down(uhf_live_link, -1200.0, "not begun: planned at E−13:20", false, -800.0);
    ground.down(x_band_link, -1200.0, "not begun: X-band sends telemetry until E−12:30", false, -750.0);
    ground.event("EDL_BEGUN", -1150.0);
    CHECK_FALSE(ground.about("uhf_live", -1000.0));
    CHECK_FALSE(ground.about("x_band", -1000.0));
    CHECK(ground.first(-1000.0).rank == Rank::waiting);
    ground.down(uhf_live_link, -765.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.sentence(-764.0) == "UHF not heard: due since E−13:20");
    ground.down(x_band_telemetry_link, -749.9, "switched off: X-band sends tones from E−12:30", false);
    ground.up(x_band_link, -749.9);
    CHECK_FALSE(ground.about("x_band_telemetry", -740.0));  // its end was planned
    ground.tone("action_unverified", -740.0);
    CHECK(ground.about("tone action_unverified", -729.0)->sentence ==
          "E−12:20, by tone: An action got no reply in time: unverified");
    ground.up(uhf_live_link, -700.0);
    CHECK_FALSE(ground.about("uhf_live", -700.0));
}

TEST_CASE("of a transmitter that a timeline which does not run has not switched on, the situation says so",
          "[situation]") {
    Ground ground;
    ground.up(x_band_telemetry_link, -1200.0);
    ground.down(x_band_link, -1200.0, "not begun: X-band sends telemetry until E−12:30", false, -750.0);
    ground.down(x_band_link, -715.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.sentence(-714.0) ==
          "“Do EDL” is not confirmed: the timeline does not run; X-band tones not heard, due since E−12:30");
    CHECK(ground.first(-714.0).rank == Rank::waiting);
    CHECK_FALSE(ground.about("x_band", -714.0));  // its cause is told: no news of its own
    ground.down(uhf_live_link, -1200.0, "not begun: planned at E−13:20", false, -800.0);
    ground.down(uhf_live_link, -700.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.sentence(-699.0) == "“Do EDL” is not confirmed: the timeline does not run; UHF not heard, due since "
                                     "E−13:20; X-band tones not heard, due since E−12:30");
    // Without telemetry nobody knows whether the timeline runs.
    ground.down(x_band_telemetry_link, -600.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.about("x_band", -599.0)->sentence ==
          "X-band tones not heard: due since E−12:30; “Do EDL” is not confirmed");
    CHECK(ground.about("uhf_live", -599.0)->rank == Rank::news);
    CHECK(ground.first(-599.0).sentence == "X-band telemetry lost since E−10:00: nothing predicted it");
}

TEST_CASE("what X-band's telemetry tells is not told again by tone, and its loss is news", "[situation]") {
    Ground ground;
    ground.up(x_band_telemetry_link, -900.0);
    ground.tone("pyro_refused", -890.0);
    CHECK_FALSE(ground.about("tone pyro_refused", -880.0));
    ground.down(x_band_telemetry_link, -870.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.about("x_band_telemetry", -869.0)->sentence ==
          "X-band telemetry lost since E−14:30: nothing predicted it");
}

TEST_CASE(
    "a link that was lost is heard again: that it was lost lasts, with how often; a silence as predicted is no loss",
    "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    ground.down(uhf_live_link, -50.0, "plasma blackout: predicted from E-0:50 to E-0:40", false, -40.0);
    ground.up(uhf_live_link, -40.0);
    CHECK_FALSE(ground.about("loss of uhf_live", -39.0));
    for (const double e_s : {-20.0, 10.0}) {
        ground.down(uhf_live_link, e_s, "unexplained: nothing is predicted to silence it now", true);
        ground.up(uhf_live_link, e_s + 5.0);
    }
    const auto loss = ground.about("loss of uhf_live", 20.0);
    REQUIRE(loss);
    CHECK(loss->rank == Rank::lasting);
    CHECK(loss->sentence == "UHF was lost 2 times, last from E+0:10 to E+0:15: nothing predicted it");
}

TEST_CASE("no prediction excuses a silence that began without one", "[situation]") {
    Ground ground;
    ground.up(x_band_link, -100.0);
    ground.up(uhf_live_link, -100.0);
    ground.down(uhf_live_link, -20.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.sentence(-19.0) == "UHF lost since E−0:20: nothing predicted it");
    ground.down(uhf_live_link, 10.0, "plasma blackout: predicted from E+0:45 to E+1:38", false, 98.0);
    const auto lost = ground.first(60.0);
    CHECK(lost.rank == Rank::news);
    CHECK(lost.sentence == "UHF lost since E−0:20, before what was predicted (plasma blackout)");
    CHECK(lost.awaited.empty());
    CHECK_FALSE(lost.at);
}

TEST_CASE("a fault that the station knows is said, within a predicted silence too, and ends with the fault",
          "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    ground.down(uhf_live_link, 50.0, "plasma blackout: predicted from E+0:45 to E+1:38", false, 98.0);
    ground.down(uhf_live_link, 60.0, "plasma blackout: predicted from E+0:45 to E+1:38; nothing comes from the station",
                true, 98.0);
    CHECK(ground.first(61.0).rank == Rank::news);
    CHECK(ground.sentence(61.0) == "A fault on the ground: nothing comes from the station (UHF silent since E+0:50)");
    ground.fired("entry_guidance", 43.0);
    CHECK(ground.about("vehicle", 61.0)->sentence ==
          "Not heard since E+0:43; landing is predicted at E+7:11; when the next word comes is not predicted");
    ground.up(x_band_link, 65.0);
    ground.down(uhf_live_link, 70.0, "plasma blackout: predicted from E+0:45 to E+1:38", false, 98.0);
    CHECK_FALSE(ground.about("station", 71.0));
    CHECK(ground.about("loss of station", 71.0)->sentence ==
          "Station was lost from E+1:00 to E+1:10: a fault on the ground");
    CHECK(ground.about("uhf_live", 71.0)->rank == Rank::silence);
}

TEST_CASE("links that fell silent together by the station's fault are named together, earlier silences not",
          "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    ground.up(x_band_link, -100.0);
    ground.down(x_band_telemetry_link, -50.0, "switched off: planned at E−12:30; nothing comes from the station", true);
    ground.down(x_band_link, 180.0, "ground fault: nothing comes from the station", true);
    ground.down(uhf_live_link, 180.0, "ground fault: nothing comes from the station", true);
    CHECK(ground.about("station", 181.0)->sentence ==
          "A fault on the ground: nothing comes from the station (UHF and X-band silent since E+3:00)");
}

TEST_CASE(
    "the backup's take-over is danger until touchdown, and a state that lasts; by tone its time is that of the tone",
    "[situation]") {
    Ground ground;
    ground.up(x_band_link, -100.0);
    ground.fired("entry_guidance", 43.0);
    ground.tone("sc_taken_over", 105.0);
    CHECK(ground.sentence(116.0) == "Flying on backup computer B, by tone at E+1:45");
    CHECK(ground.first(116.0).evidence.starts_with("heard by tone: "));
    ground.event("SECOND_CHANCE_TAKES_OVER", 100.3);
    const auto all = ground.monitor.at(at(120.0));
    CHECK(all.front().rank == Rank::danger);
    CHECK(all.front().sentence == "Flying on backup computer B since E+1:40: it took over the timeline");
    CHECK(all.front().evidence == "event SECOND_CHANCE_TAKES_OVER");
    const auto lasting = std::ranges::find(all, Rank::lasting, &SituationEntry::rank);
    REQUIRE(lasting != all.end());
    CHECK(std::ranges::count(all, all.front().sentence, &SituationEntry::sentence) == 2);
    ground.event("TOUCHDOWN", 433.0, "Touchdown");
    CHECK(ground.sentence(440.0) == "Touchdown reported at E+7:13");
    CHECK(ground.about("computer", 440.0)->rank == Rank::news);
}

TEST_CASE("a touchdown is reported by its own evidence alone; until then landing was predicted", "[situation]") {
    Ground ground;
    ground.up(x_band_link, -100.0);
    ground.down(uhf_live_link, -100.0, "no orbiter in view: odyssey rises at E+2:00:00", false, 7200.0);
    ground.tone("heatshield_separation", 283.0);
    ground.down(x_band_link, 298.0, "Earth set: predicted at E+4:58");
    CHECK(ground.sentence(300.0) ==
          "Not heard since E+4:43; landing is predicted at E+7:11; next word when Odyssey rises at E+2:00:00");
    const auto later = ground.first(3600.0);
    CHECK(later.sentence ==
          "Not heard since E+4:43; landing was predicted at E+7:11; next word when Odyssey rises at E+2:00:00");
    CHECK(later.rank == Rank::silence);
    CHECK(later.at == at(7200.0));
    CHECK(later.evidence == "last heard by tone: heatshield separation, posterior 0.999");
    CHECK(ground.first(7201.0).overdue);
    CHECK_FALSE(ground.about("landed", 7201.0));
    ground.up(relay_link, 7210.0);
    ground.event("TOUCHDOWN", 433.0, "Touchdown", true);
    CHECK(ground.sentence(7300.0) == "Touchdown reported at E+7:13, by the recording");
}

TEST_CASE("a touchdown is confirmed in the second in which all three signals are there, and a newer flag takes it back",
          "[situation][touchdown][R53]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    const auto sample = [&](double e_s, double declared) {
        ground.monitor.touchdown({sclk(e_s), declared, 0.0007, still_weight_mps2, true}, ground.from(e_s));
    };
    for (double e_s = 428.0; e_s < 433.0; e_s += 1.0) sample(e_s, 0.0);
    ground.event("TOUCHDOWN", 432.5, "Touchdown");
    for (double e_s = 433.0; e_s < 443.0; e_s += 1.0) {
        sample(e_s, 1.0);
        CHECK(ground.sentence(e_s) == "Touchdown reported at E+7:12");
    }
    sample(443.0, 1.0);
    const auto confirmed = ground.first(443.0);
    CHECK(confirmed.sentence == "Touchdown confirmed, at E+7:12");
    CHECK(confirmed.rank == Rank::news);
    CHECK(confirmed.evidence_seq == ground.seq);
    CHECK(confirmed.evidence.starts_with("touchdown told by the vehicle: E+7:12.5: event TOUCHDOWN; rover's own IMU"));
    for (double e_s = 444.0; e_s < 600.0; e_s += 1.0) sample(e_s, 1.0);  // more than is kept
    CHECK(ground.first(600.0) == confirmed);
    sample(600.0, 0.0);
    CHECK(ground.first(600.0).rank == Rank::danger);
    CHECK(ground.sentence(600.0) ==
          "Touchdown contradicted: event TOUCHDOWN at E+7:12.5, but touchdown_declared is 0 at E+10:00.0");
    for (double e_s = 601.0; e_s < 604.0; e_s += 1.0) sample(e_s, 1.0);
    CHECK(ground.sentence(604.0) == "Touchdown confirmed, at E+7:12");
    CHECK(ground.first(604.0).rank == Rank::news);
    sample(602.5, 0.0);  // an older flag, late
    sample(604.0, 1.0);
    sample(604.0, 1.0);  // twice
    CHECK(ground.sentence(605.0) == "Touchdown confirmed, at E+7:12");
}

TEST_CASE(
    "a confirmed touchdown is news until its recording comes, and lasts from then; one reported alone stays first",
    "[situation][touchdown]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    ground.event("TOUCHDOWN", 432.5, "Touchdown");
    ground.down(uhf_live_link, 460.0, "switched off: as planned", false);
    ground.up(relay_link, 500.0);
    CHECK(ground.sentence(501.0) == "Touchdown reported at E+7:12");
    CHECK(ground.about("recording", 501.0)->rank == Rank::waiting);
    ground.down(relay_link, 510.0, "no orbiter in view", false, 900.0);
    for (double e_s = 433.0; e_s < 444.0; e_s += 1.0)
        ground.monitor.touchdown({sclk(e_s), 1.0, 0.0007, still_weight_mps2, true}, ground.from(e_s));
    const auto landed = ground.about("landed", 511.0);
    CHECK(landed->sentence == "Touchdown confirmed, at E+7:12");
    CHECK(landed->rank == Rank::lasting);
    CHECK(ground.about("recording", 511.0)->rank == Rank::waiting);
    ground.up(relay_link, 900.0);
    CHECK(ground.first(901.0).sentence == "The recording comes down");
    CHECK(ground.first(901.0).rank == Rank::news);
    ground.monitor.touchdown({sclk(1000.0), 0.0, 0.0007, still_weight_mps2, true}, ground.from(1000.0));
    CHECK(ground.first(1001.0).sentence.starts_with("Touchdown contradicted"));
}

TEST_CASE("samples of the touchdown that come late or doubled are judged by the time on board",
          "[situation][touchdown][R53]") {
    const auto confirmed_after = [](const std::vector<double>& order) {
        Ground ground;
        ground.up(uhf_live_link, -100.0);
        ground.event("TOUCHDOWN", 432.5, "Touchdown");
        std::size_t given = 0;
        for (const double e_s : order) {
            ground.monitor.touchdown({sclk(e_s), 1.0, 0.0007, still_weight_mps2, true}, ground.from(e_s));
            ++given;
            if (ground.about("landed", 600.0)->sentence.starts_with("Touchdown confirmed")) break;
        }
        return given;
    };
    std::vector<double> order;
    for (double e_s = 433.0; e_s <= 443.0; e_s += 1.0) order.push_back(e_s);
    CHECK(confirmed_after(order) == 11);
    auto swapped = order;
    std::swap(swapped[4], swapped[7]);
    CHECK(confirmed_after(swapped) == 11);
    auto doubled = order;
    doubled.insert(doubled.begin() + 3, order[2]);
    CHECK(confirmed_after(doubled) == 12);
    auto late = order;  // the last but one comes last: no gap was without a sample
    std::swap(late[9], late[10]);
    CHECK(confirmed_after(late) == 10);
}

TEST_CASE("a touchdown that is heard by tones alone, or whose UHF stops, stays reported", "[situation][touchdown]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    ground.event("TOUCHDOWN", 432.5, "Touchdown");
    for (double e_s = 433.0; e_s < 440.0; e_s += 1.0)
        ground.monitor.touchdown({sclk(e_s), 1.0, 0.0007, still_weight_mps2, true}, ground.from(e_s));
    ground.down(uhf_live_link, 440.0, "unexplained: nothing is predicted to silence it now", true);
    CHECK(ground.about("landed", 500.0)->sentence == "Touchdown reported at E+7:12");
    Ground tones;
    tones.up(x_band_link, -100.0);
    tones.tone("touchdown", 431.0);
    for (double e_s = 433.0; e_s < 460.0; e_s += 1.0)  // of a link that brings no EDL phase
        tones.monitor.touchdown({sclk(e_s), {}, 0.0007, still_weight_mps2, false}, tones.from(e_s));
    CHECK(tones.about("landed", 500.0)->sentence == "Touchdown reported at E+7:11, by tone");
}

TEST_CASE("what the ground awaits is the next step, with the condition that is missing, and overdue when it is late",
          "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -100.0);
    CHECK(ground.first(-50.0).sentence == "“Do EDL” is not confirmed: the timeline does not run");
    CHECK(ground.first(-50.0).awaited == "entry");
    CHECK(ground.first(10.0).awaited.empty());  // what is past is not counted to
    ground.fired("sufr", 240.0);
    ground.fired("balance_3", 244.0);
    const auto waiting = ground.first(250.0);
    CHECK(waiting.rank == Rank::waiting);
    CHECK(waiting.sentence == "Waiting for parachute deploy");
    REQUIRE(waiting.at);
    CHECK(static_cast<double>(waiting.at->microseconds - at(0.0).microseconds) * 1e-6 == Approx(255.9 + 1.0));
    Explanation held;
    held.decision = "parachute";
    held.verdict = "held";
    held.conditions = {{"radar_ready", 1.0, "==", 1.0, true}, {"speed_mps", 420.0, "<=", 405.0, false}};
    ground.monitor.explained(held, ground.from(251.0));
    CHECK(ground.sentence(251.0) == "Waiting for parachute deploy, not yet speed ≤ 405.0 m/s at E+4:11");
    CHECK(ground.sentence(257.0) == "Waiting for parachute deploy");  // it would have been told again
    CHECK_FALSE(ground.first(258.0).overdue);
    CHECK(ground.first(263.0).overdue);
    ground.event("TIMEPOINT_OFFSET_CHANGED", 264.0);
    CHECK_FALSE(ground.first(264.0).at);  // what was predicted may no longer hold
}

TEST_CASE("news stays until something follows it: a command that failed, until one of its name is done",
          "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -900.0);
    ground.monitor.stage({1, "EDL_DO_EDL", "refused: not in late cruise", true, false}, ground.from(-800.0));
    CHECK(ground.sentence(-700.0) == "EDL_DO_EDL failed: refused: not in late cruise");
    ground.monitor.stage({2, "NO_OP", "cancelled by Ann", true, false}, ground.from(-790.0));
    CHECK_FALSE(ground.about("command NO_OP", -700.0));
    ground.monitor.stage({3, "EDL_DO_EDL", "event EDL_BEGUN", false, true}, ground.from(-600.0));
    CHECK_FALSE(ground.about("command EDL_DO_EDL", -500.0));
    ground.event("TIMEPOINT_UNVERIFIED", -400.0, "Timepoint 3: no reply in time, unverified");
    CHECK(ground.sentence(-399.0) == "E−6:40: Timepoint 3: no reply in time, unverified");
    ground.event("TIMEPOINT_VERIFIED_LATE", -390.0);
    CHECK(ground.first(-389.0).rank == Rank::waiting);
    // A mortar that is said to have refused, and whose parachute the IMU feels, has fired.
    ground.event("TIMEPOINT_REFUSED", -380.0, "Timepoint 3: refused, not taken as done");
    CHECK(ground.sentence(-379.0) == "E−6:20: Timepoint 3: refused, not taken as done");
    ground.event("TIMEPOINT_FELT", -378.0);
    CHECK(ground.first(-377.0).rank == Rank::waiting);
    // So has a pyro whose controllers say so after all.
    ground.event("TIMEPOINT_REFUSED", -370.0, "Timepoint 3: refused, not taken as done");
    ground.event("TIMEPOINT_VERIFIED_LATE", -368.0);
    CHECK(ground.first(-367.0).rank == Rank::waiting);
}

TEST_CASE("danger is above all news: a failed check on board, a limit that is critical", "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -900.0);
    ground.event("FATAL_CHECK_FAILED", -500.0, "A check on board failed");
    ground.event("TIMEPOINT_UNVERIFIED", -400.0);
    CHECK(ground.first(-399.0).rank == Rank::danger);
    ground.event("COMPUTER_STARTED", -470.0);
    CHECK(ground.first(-399.0).rank == Rank::news);
    const auto& channel = *tests::shipped_dictionary().channel("sensed_deceleration_g");
    ground.monitor.alarm(channel.id, dictionary::Severity::critical, "> 16 g", sclk(70.0), ground.from(70.0));
    CHECK(ground.sentence(71.0) == "Sensed deceleration > 16 g: critical since E+1:10");
    ground.monitor.alarm(channel.id, dictionary::Severity::warning, "> 14.5 g", sclk(80.0), ground.from(80.0));
    CHECK(ground.first(81.0).rank == Rank::news);
}

TEST_CASE("after a designation the other computer is the backup; a designation of neither names none", "[situation]") {
    const auto flying_after = [](const std::string& number) {
        Ground ground;
        ground.up(uhf_live_link, -900.0);
        std::string text = tests::shipped_dictionary().event("PRIME_DESIGNATED")->format;
        text.replace(text.find('{'), std::string("{string_number}").size(), number);
        ground.event("PRIME_DESIGNATED", -880.0, text);
        ground.event("SECOND_CHANCE_TAKES_OVER", 100.3);
        return ground.sentence(116.0);
    };
    CHECK(flying_after("1") == "Flying on backup computer A since E+1:40: it took over the timeline");
    CHECK(flying_after("0") == "Flying on backup computer B since E+1:40: it took over the timeline");
    CHECK(flying_after("?") == "Flying on the backup computer since E+1:40: it took over the timeline");
}

TEST_CASE("a tone that is not sure enough says nothing, and what went wrong is told by tone only without UHF",
          "[situation]") {
    Ground ground;
    ground.up(x_band_link, -900.0);
    ground.tone("touchdown", 431.0, 0.6);
    CHECK_FALSE(ground.about("landed", 450.0));
    ground.tone("pyro_refused", 260.0);
    CHECK(ground.sentence(271.0) == "E+4:20, by tone: A pyro was refused");
    CHECK(ground.first(271.0).evidence.ends_with(" pyro refused, posterior 0.999"));
    ground.tone("pyro_refused", 280.0, 0.99999);
    CHECK(ground.first(291.0).evidence.ends_with(", posterior above 0.999"));  // nothing is certain
    Ground with_uhf;
    with_uhf.up(uhf_live_link, -900.0);
    with_uhf.tone("pyro_refused", 260.0);
    CHECK_FALSE(with_uhf.about("tone pyro_refused", 271.0));
}

TEST_CASE("it is too late for planned steps when nothing sent now can precede a planned step, a light time each way "
          "before it",
          "[situation]") {
    const SituationMonitor monitor = monitor_at(100.0);
    const auto closed = [&](double seen_e_s) {
        const auto all = monitor.at({at(seen_e_s).microseconds + 100'000'000});
        return std::ranges::any_of(all, [](const auto& entry) {
            return entry.rank == Rank::lasting && entry.sentence.starts_with("Too late for planned steps since E−3:20");
        });
    };
    CHECK_FALSE(closed(-201.0));
    CHECK(closed(-200.0));
}

TEST_CASE("the list is bounded, and keeps what is most important and what lasts", "[situation]") {
    Ground ground;
    ground.up(uhf_live_link, -900.0);
    for (int i = 0; i < 100; ++i)
        ground.monitor.stage({static_cast<std::uint64_t>(i), "COMMAND_" + std::to_string(i), "refused", true, false},
                             ground.from(-800.0 + i));
    const auto all = ground.monitor.at(at(10.0));
    CHECK(all.size() == SituationMonitor::entries_max);
    CHECK(std::ranges::any_of(all, [](const auto& entry) { return entry.rank == Rank::lasting; }));
    CHECK_THAT(all.front().sentence, Catch::Contains("Too late for planned steps") || Catch::Contains("COMMAND_99"));
}

TEST_CASE("of another mission, whose entry nobody knows, times are of day, and nothing is awaited", "[situation]") {
    dictionary::Dictionary other;
    SituationMonitor monitor{other, {}};
    CHECK(monitor.at(Ert{0}).front().sentence == "Nothing comes yet");
    monitor.link({downlink_link, Ert{0}, true, "connected"}, {1, Ert{0}});
    CHECK(monitor.at(Ert{0}).front().rank == Rank::calm);
    monitor.link({downlink_link, Ert{60'000'000}, false, "ground fault: refused", true}, {2, Ert{60'000'000}});
    const auto all = monitor.at(Ert{61'000'000});
    CHECK(all.front().rank == Rank::news);
    CHECK_THAT(all.front().sentence, Catch::Contains("2000-001T12:01:00.000"));
}

TEST_CASE("of another mission nothing comes yet until something came, and then the last packet is told",
          "[situation]") {
    dictionary::Dictionary other;
    SituationMonitor monitor{other, {}};
    const auto waiting = [&](Ert now) {
        const auto all = monitor.at(now);
        const auto found = std::ranges::find(all, "waiting", &SituationEntry::subject);
        REQUIRE(found != all.end());
        return found->sentence;
    };
    monitor.link({downlink_link, Ert{0}, false, "connected, no packet has come yet"}, {1, Ert{0}});
    CHECK(waiting(Ert{0}) == "Nothing comes yet");
    monitor.link({downlink_link, Ert{1'000'000}, true, "packets come"}, {2, Ert{1'000'000}});
    CHECK(waiting(Ert{1'000'000}) == "Listening");
    SituationMonitor recorded = monitor;
    monitor.heard(Sclk{}, Ert{60'000'000});
    monitor.heard(Sclk{}, Ert{59'000'000});
    for (SituationMonitor* each : {&monitor, &recorded})
        each->link({downlink_link, Ert{90'000'000}, false, "no packet since", true, {}, SilenceClass::unexplained},
                   {4, Ert{90'000'000}});
    CHECK(waiting(Ert{91'000'000}) == "Nothing comes now: the last packet came at 2000-001T12:01:00.000");
    CHECK(recorded.at(Ert{91'000'000}).size() == 2);
    monitor.link({downlink_link, Ert{95'000'000}, true, "packets come"}, {5, Ert{95'000'000}});
    CHECK(waiting(Ert{95'000'000}) == "Listening");
}

TEST_CASE("what ground's own flight expects goes before the plan, and is overdue only behind its interval",
          "[situation][shadow][R57]") {
    Ground ground;
    ground.up(uhf_live_link, -600.0);
    ground.event("EDL_BEGUN", -1150.0);
    ground.fired("sufr", 239.0);
    for (const char* balance : {"balance_1", "balance_2", "balance_3"}) ground.fired(balance, 244.0);
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto mortar = std::ranges::find(timeline, "parachute_deploy", &dictionary::TimelineRow::name)->id;
    const auto waits = [&](double e_s) {
        const auto step = ground.about("step", e_s);
        REQUIRE(step);
        CHECK(step->timepoint == "parachute_deploy");
        return *step;
    };
    const auto by_plan = waits(245.0).at;
    ground.monitor.expected(mortar, SituationMonitor::ExpectedStep{262.0, 270.0});
    CHECK(waits(245.0).at == at(262.0));
    ground.monitor.heard(sclk(274.0), at(274.0));
    CHECK_FALSE(waits(274.0).overdue);
    ground.monitor.heard(sclk(276.0), at(276.0));
    CHECK(waits(276.0).overdue);
    ground.monitor.expected(mortar, std::nullopt);
    CHECK(waits(245.0).at == by_plan);
}

}  // namespace telemetry_situation_monitor_test
