// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/scripted_landing.hpp"

#include "commands/changed_timeline.hpp"
#include "commands/timeline_change.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"
#include "server/rehearsal/predict_silences.hpp"
#include "server/rehearsal/predicted_doppler.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <functional>
#include <utility>

namespace aeolis::server {
namespace {

/// Events in the recording that report decisions unseen by the truth: those of the same name in capitals.
std::vector<simulation::EventReportName> event_reports(const dictionary::Dictionary& dictionary) {
    std::vector<simulation::EventReportName> reports;
    for (const std::string name : simulation::decided_on_board) {
        std::string capitals = name;
        std::ranges::transform(capitals, capitals.begin(),
                               [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
        if (const dictionary::Event* event = dictionary.event(capitals))
            reports.push_back({dictionary.packets[event->packet].apid, event->id, name});
    }
    return reports;
}

commands::TrackingSchedule stations_of(const simulation::Scenario& scenario) {
    const auto ert = [&](double after_entry_s) {
        return Ert{scenario.entry_scet.microseconds + static_cast<std::int64_t>(after_entry_s * 1.0e6)};
    };
    std::vector<commands::TrackingPass> passes;
    passes.reserve(scenario.radio.tracking_passes.size());
    for (const auto& pass : scenario.radio.tracking_passes)
        passes.push_back({pass.station, ert(pass.begin_after_entry_s), ert(pass.end_after_entry_s)});
    return commands::TrackingSchedule{std::move(passes)};
}

constexpr std::uint64_t cycles_between_silences = 64;  // one second: soon enough to report silences

}  // namespace

std::vector<commands::NamedValue> solution_arguments(const simulation::NavigationSolution& solution) {
    return {
        {"solution_id", static_cast<double>(solution.solution_id)},
        {"epoch_sclk", solution.epoch.seconds},
        {"position_x_m", solution.p_MoB_M_m[0]},
        {"position_y_m", solution.p_MoB_M_m[1]},
        {"position_z_m", solution.p_MoB_M_m[2]},
        {"velocity_x_mps", solution.v_MB_M_mps[0]},
        {"velocity_y_mps", solution.v_MB_M_mps[1]},
        {"velocity_z_mps", solution.v_MB_M_mps[2]},
        {"entry_sclk", solution.entry.seconds},
        {"target_latitude_deg", solution.target.latitude_deg},
        {"target_longitude_deg", solution.target.longitude_deg},
        {"target_radius_m", solution.target.radius_m},
        {"parachute_speed_mps", solution.parachute_speed_mps},
        {"heatshield_speed_mps", solution.heatshield_speed_mps},
        {"backshell_altitude_m", solution.backshell_altitude_m},
    };
}

ClockCorrelation clock_of(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary) {
    constexpr std::int64_t same_us = 1000;  // chosen: resolution of a day-of-year text
    const auto* known = dictionary.clock_at(scenario.entry_sclk);
    if (known != nullptr &&
        std::abs(known->scet_of(scenario.entry_sclk).microseconds - scenario.entry_scet.microseconds) < same_us)
        return *known;
    ClockCorrelation own;
    own.sclk = scenario.entry_sclk;
    own.scet = scenario.entry_scet;
    return own;
}

std::deque<ScriptedRequest> script_of(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary) {
    std::deque<ScriptedRequest> script;
    for (const auto& command : scenario.commands) {
        commands::Request request;
        request.command = command.command;
        request.from_solution = command.from_solution;
        for (const auto& [name, value] : command.arguments) request.arguments.push_back({name, value});
        // The scenario's author has armed and confirmed the command.
        request.armed = true;
        request.confirmation = command.command;
        script.push_back({command.send_before_entry_s, std::move(request), {}});
    }
    std::ranges::stable_sort(script, std::greater{}, &ScriptedRequest::send_before_entry_s);
    commands::ChangedTimeline timeline{dictionary};
    for (ScriptedRequest& each : script) {
        if (!commands::changes_offsets(each.request.command)) continue;
        auto changed = timeline;
        if (!changed.change(each.request.command, each.request.arguments)) continue;  // the gateway says what is wrong
        if (const auto verdict =
                commands::verdict_on(changed.dictionary(), dictionary::analyse_bounds(changed.dictionary())))
            timeline = std::move(changed);
        else
            each.refused = verdict.error().message;
    }
    return script;
}

ScriptedLanding::ScriptedLanding(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                                 const dictionary::Dictionary& dictionary, const std::optional<ClockCorrelation>& clock)
    : entry_(scenario.entry_sclk),
      landing_(scenario, seed, case_number, event_reports(dictionary), clock ? *clock : clock_of(scenario, dictionary)),
      station_(landing_.light_time_s()),
      gateway_(dictionary, landing_.light_time_s(), solution_arguments(landing_.solution()), scenario.second_person,
               stations_of(scenario), landing_.correlation().scet_of(scenario.entry_sclk), landing_.correlation(),
               scenario.radio.uhf_rate_bps),
      script_(script_of(scenario, dictionary)), dispersed_(landing_.dispersed()), decoder_(dictionary),
      progress_(dictionary) {}

void ScriptedLanding::equip_station(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                                    const dictionary::Dictionary& dictionary) {
    // When a signal sent at the predicted entry is received on Earth.
    const Ert entry{landing_.correlation().scet_of(scenario.entry_sclk).microseconds +
                    static_cast<std::int64_t>(landing_.light_time_s() * 1e6)};
    station_.explain_by({predict_silences(simulation::as_believed(scenario), dictionary), landing_.ert_now(), entry});
    const auto predicted = predicted_flight(scenario, dictionary.mfsk);
    const TimeTable& predict_hz = predicted.doppler_hz;
    station_.watch_by({predict_hz, entry, predicted.reversals_s});
    if (!scenario.radio.tones_from_samples.value_or(false)) {
        landing_.listen_by({scenario.radio.x_band_c_n0_dbhz, predict_hz, seed, case_number});
        return;
    }
    landing_.listen_by({dictionary.mfsk, scenario.radio.x_band_c_n0_dbhz, predict_hz, seed, case_number});
    station_.listen_by({dictionary.mfsk, predict_hz, entry});
}

void ScriptedLanding::send_solution(const simulation::NavigationSolution& solution) {
    gateway_.renew_solution(solution_arguments(solution));
}

telemetry::Received& ScriptedLanding::step() {
    send_script();
    for (const auto& cltu : gateway_.take_uplinks()) landing_.uplink(cltu);
    auto& received = station_.receive(landing_.step().earth);
    if (!received.links.empty() || cycles_ % cycles_between_silences == 0)
        station_.explain_silences(recording_progress());
    for (const auto& pltu : station_.take_forward()) landing_.forward(pltu);
    ++cycles_;
    if (landing_.dispersed() && !std::exchange(dispersed_, true))
        gateway_.renew_solution(solution_arguments(landing_.solution()));
    return received;
}

void ScriptedLanding::hear(telemetry::Received& received) {
    for (auto& packet : received.packets) receive(packet);
    // Once a second suffices for windows of many seconds; what waits for its turn leaves as soon as it may.
    const Ert now = landing_.ert_now();
    if (cycles_ % 64 == 0)
        gateway_.pass(now, stages_);
    else if (gateway_.may_leave(now))
        gateway_.release_due(now, stages_);
}

const telemetry::DecodedPacket& ScriptedLanding::decoded(telemetry::ReceivedPacket& packet) const {
    if (!packet.decoded) {
        auto decoded = std::make_shared<telemetry::DecodedPacket>();
        decoder_.decode(packet.octets, *decoded);
        packet.decoded = std::move(decoded);
    }
    return *packet.decoded;
}

void ScriptedLanding::receive(telemetry::ReceivedPacket& packet) {
    const bool live = telemetry::is_live_telemetry(packet.link.name);
    if (!live && !gateway_.awaits_answers()) return;
    const auto& [content, refusal, event, text] = decoded(packet);
    if (!refusal.empty()) return;
    if (live) progress_.note(content);
    gateway_.receive({content, packet.octets, live, packet.ert, event, text}, stages_);
}

void ScriptedLanding::send_script() {
    for (; !script_.empty() && landing_.sclk() >= entry_ - script_.front().send_before_entry_s; script_.pop_front()) {
        const ScriptedRequest& due = script_.front();
        if (due.refused.empty()) {
            const auto reply =
                gateway_.submit(due.request, landing_.ert_now(), stages_, commands::CommandGateway::Asker::script);
            if (!reply.accepted) refuse(due.request, reply.reason);
        } else {
            refuse(due.request, due.refused);
        }
    }
}

void ScriptedLanding::refuse(const commands::Request& request, const std::string& reason) {
    script_refusals_.push_back(reason);
    gateway_.note_refused(request, reason, landing_.ert_now(), stages_);
}

commands::Reply ScriptedLanding::submit(const commands::Request& request) {
    return gateway_.submit(request, landing_.ert_now(), stages_);
}

Result<void> ScriptedLanding::judge(const commands::TimelineVerdict& verdict) {
    return gateway_.judge(verdict, landing_.ert_now(), stages_);
}

double ScriptedLanding::recording_progress() const {
    return progress_.fraction(station_.recording());
}

std::string text_of_bug(const CheckFailed& bug) {
    return fmt::format("a check failed in the simulation: {} ({}:{})", bug.what(), bug.file(), bug.line());
}

std::vector<commands::StageReport> ScriptedLanding::take_stages() {
    return std::exchange(stages_, {});
}

}  // namespace aeolis::server
