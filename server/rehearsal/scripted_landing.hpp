// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/command_gateway.hpp"
#include "common/check.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/landing.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/station/ground_station.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// A landing with its command path, and the scenario's own script, which goes through it.
///
/// In       cycles to step; commands                    Out   what the station received; stages of commands
/// Rate     as fast as it is called                     Memory   the recording: some megabytes
/// A value: copy it and the landing is forked, with what ground knows of it.
class ScriptedLanding {
  public:
    /// The dictionary must outlive this and its copies. `clock`: of a run that was begun before; else that of the
    /// dictionary, where it is the scenario's.
    ScriptedLanding(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                    const dictionary::Dictionary& dictionary, const std::optional<ClockCorrelation>& clock = {});

    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner) { landing_.run_prime_by(std::move(runner)); }
    /// See Landing::take_case.
    void take_case(std::uint64_t case_number) { landing_.take_case(case_number); }

    /// The station decodes tones from samples, where the scenario has them so, and explains silences. Before the first
    /// step.
    void equip_station(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary);

    /// One cycle of 1/64 s, after the script's commands that are due. What was received stands until the next step.
    const telemetry::Received& step();
    /// What was received is taken in by the command path: for answers, and for the preconditions of what is sent later.
    void hear(const telemetry::Received& received);

    commands::Reply submit(const commands::Request& request);
    /// See CommandGateway::look.
    std::vector<commands::Reply> look(std::span<const commands::Request> file) {
        return gateway_.look(file, landing_.ert_now());
    }

    /// See CommandGateway::judge.
    Result<void> judge(const commands::TimelineVerdict& verdict);

    void inject(const simulation::Fault& fault) { landing_.inject(fault); }

    bool script_sent() const { return script_.empty(); }
    /// Stages since the last call.
    std::vector<commands::StageReport> take_stages();
    /// Reasons for which commands of the script were refused.
    const std::vector<std::string>& script_refusals() const { return script_refusals_; }

    const simulation::Landing& landing() const { return landing_; }
    const commands::CommandGateway& gateway() const { return gateway_; }
    const telemetry::GroundStation& station() const { return station_; }
    double recording_progress() const;  ///< 0 … 1 of the recording that has come down

  private:
    void receive(const telemetry::ReceivedPacket& packet);
    void send_script();
    void radiate();

    const dictionary::Dictionary& dictionary_;
    Sclk entry_;
    simulation::Landing landing_;
    telemetry::GroundStation station_;
    commands::CommandGateway gateway_;
    std::vector<simulation::ScriptedCommand> script_;  ///< not sent yet
    std::vector<commands::StageReport> stages_;
    std::vector<std::string> script_refusals_;
    bool dispersed_;
    std::uint64_t cycles_ = 0;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
};

/// Ground's navigation solution as arguments of "set edl parameters", by argument name.
std::vector<commands::NamedValue> solution_arguments(const simulation::NavigationSolution& solution);

/// What is told of a landing that a bug has ended.
std::string text_of_bug(const CheckFailed& bug);

}  // namespace aeolis::server
