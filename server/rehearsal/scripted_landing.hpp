// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/command_gateway.hpp"
#include "common/check.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/landing.hpp"
#include "telemetry/decoded_packet.hpp"
#include "telemetry/station/ground_station.hpp"
#include "telemetry/station/recording_progress.hpp"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// A command of a scenario's script.
struct ScriptedRequest {
    double send_before_entry_s = 0.0;
    commands::Request request;
    std::string refused;  ///< the constraint that it would break, after the changes before it; empty: none
};
/// The script in the order of sending. Each change of the timeline is analysed like one sent by hand, which takes a
/// second of one processor. R19, R51
std::deque<ScriptedRequest> script_of(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary);

/// The clock correlation from the dictionary if it is the scenario's clock; else the scenario's.
ClockCorrelation clock_of(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary);

/// A landing with its command path and the scenario's own script, which is sent through that path.
///
/// In       cycles to step; commands                    Out   what the station received; stages of commands
/// Rate     as fast as it is called                     Memory   the recording: some megabytes
///
/// A value: a copy forks the landing, including ground's knowledge of it.
class ScriptedLanding {
  public:
    /// The dictionary must outlive this and its copies. `clock`: that of a run begun earlier; none: the dictionary's,
    /// if it is the scenario's.
    ScriptedLanding(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                    const dictionary::Dictionary& dictionary, const std::optional<ClockCorrelation>& clock = {});

    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner) { landing_.run_prime_by(std::move(runner)); }
    /// See Landing::take_case.
    void take_case(std::uint64_t case_number) { landing_.take_case(case_number); }
    /// See Landing::redraw.
    void redraw(std::uint64_t seed, std::uint64_t case_number,
                const std::optional<simulation::StateKnowledge>& knowledge = {}) {
        landing_.redraw(seed, case_number, knowledge);
    }

    /// Sends this solution, where a command takes its arguments from ground's, instead of that of the landing itself.
    void send_solution(const simulation::NavigationSolution& solution);

    /// See Landing::shift.
    void shift(const flight::NavigationShift& vehicle, const flight::NavigationShift& navigation) {
        landing_.shift(vehicle, navigation);
    }

    /// Equips the station to decode tones from samples, if the scenario says so, and to explain silences. Call before
    /// the first step.
    void equip_station(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary);

    /// Sends the script's commands that are due, passes to the vehicle what the gateway radiates, then flies one cycle
    /// of 1/64 s. The result is valid until the next step, and until then the caller's to move from.
    telemetry::Received& step();
    /// Gives received packets to the command path, for replies and for the preconditions of later commands. Decodes
    /// those that it needs.
    void hear(telemetry::Received& received);
    /// The packet's content, decoded now unless it was before.
    const telemetry::DecodedPacket& decoded(telemetry::ReceivedPacket& packet) const;

    commands::Reply submit(const commands::Request& request);
    /// See CommandGateway::look.
    std::vector<commands::Reply> look(std::span<const commands::Request> file) {
        return gateway_.look(file, landing_.ert_now());
    }

    /// See CommandGateway::judge.
    Result<void> judge(const commands::TimelineVerdict& verdict);

    void inject(const simulation::Fault& fault) { landing_.inject(fault); }

    bool script_sent() const { return script_.empty(); }
    /// The stages since the last call.
    std::vector<commands::StageReport> take_stages();
    /// Why commands of the script were refused.
    const std::vector<std::string>& script_refusals() const { return script_refusals_; }

    const simulation::Landing& landing() const { return landing_; }
    const commands::CommandGateway& gateway() const { return gateway_; }
    const telemetry::GroundStation& station() const { return station_; }
    /// See telemetry::RecordingProgress::fraction.
    double recording_progress() const;

  private:
    void receive(telemetry::ReceivedPacket& packet);
    void send_script();
    void refuse(const commands::Request& request, const std::string& reason);

    Sclk entry_;
    simulation::Landing landing_;
    telemetry::GroundStation station_;
    commands::CommandGateway gateway_;
    std::deque<ScriptedRequest> script_;  ///< not yet sent, in the order of sending
    std::vector<commands::StageReport> stages_;
    std::vector<std::string> script_refusals_;
    bool dispersed_;
    std::uint64_t cycles_ = 0;
    telemetry::PacketDecoder decoder_;
    telemetry::RecordingProgress progress_;
};

/// Ground's navigation solution as arguments of "set edl parameters", by argument name.
std::vector<commands::NamedValue> solution_arguments(const simulation::NavigationSolution& solution);

/// The outcome text of a landing ended by a failed check.
std::string text_of_bug(const CheckFailed& bug);

}  // namespace aeolis::server
