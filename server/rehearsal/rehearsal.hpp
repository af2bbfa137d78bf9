// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/base/digest.hpp"
#include "server/rehearsal/recorded_firings.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/rehearsal/tone_score.hpp"
#include "server/venue/threaded_executive.hpp"
#include "simulation/landing.hpp"
#include "simulation/limits.hpp"
#include "telemetry/product_assembler.hpp"
#include "telemetry/proof.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// One run: the landing, its command path, its script and its score. No thread, no clock, no disk.
///
/// In       cycles to step; commands                    Out   what ground received; stages of commands; the score
/// Rate     as fast as it is called                     Memory   the recording and its register: tens of megabytes
/// Faults   a failed check in the simulation ends the run as lost; the reason is the broken condition
class Rehearsal {
  public:
    /// The dictionary must outlive this. A `runner` replaces the prime computer's executive; a `clock` is that of a run
    /// begun earlier.
    Rehearsal(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
              const dictionary::Dictionary& dictionary, std::shared_ptr<flight::CycleRunner> runner = {},
              const std::optional<ClockCorrelation>& clock = {});

    /// Sends the script's commands that are due, then flies one cycle of 1/64 s. The result is valid until the next
    /// step, and until then the caller's to move from.
    telemetry::Received& step();

    /// See request_of().
    v1::CommandReply submit(const v1::CommandRequest& request, const std::string& browser = {}, bool director = false);
    /// See commands::CommandGateway::look.
    std::vector<v1::CommandReply> look(std::span<const v1::CommandRequest> file, const std::string& browser = {});
    /// See commands::CommandGateway::judge.
    Result<void> judge(const commands::TimelineVerdict& verdict) { return flight_.judge(verdict); }

    /// Injects a fault from the next cycle on. The Error names the field at fault.
    Result<void> inject(const v1::FaultInjection& injection);

    /// See Landing::redraw. The Error says why nothing can be drawn anew yet.
    Result<void> redraw(std::uint64_t seed);

    /// See ScriptedLanding::send_solution.
    void send_solution(const simulation::NavigationSolution& solution) { flight_.send_solution(solution); }

    /// See Landing::shift.
    void shift(const flight::NavigationShift& vehicle, const flight::NavigationShift& navigation) {
        flight_.shift(vehicle, navigation);
    }

    /// The stages since the last call, without `seq`.
    std::vector<archive::StageRecord> take_stages();
    /// Why commands of the scenario's own script were refused.
    const std::vector<std::string>& script_refusals() const { return flight_.script_refusals(); }

    bool finished() const { return !broken_.empty() || landing().finished(); }
    archive::Outcome outcome() const;
    std::string outcome_reason() const;  ///< with the limits that a landing did not keep
    /// The judgement by the scenario's limits.
    simulation::Judgement judgement() const;
    std::string digest() const { return digest_.text(); }

    archive::RunStart run_start(double pace) const;
    v1::Clocks clocks() const;

    const simulation::Scenario& scenario() const { return scenario_; }
    const ScriptedLanding& flight() const { return flight_; }
    const simulation::Landing& landing() const { return flight_.landing(); }
    const commands::CommandGateway& gateway() const { return flight_.gateway(); }
    const telemetry::GroundStation& station() const { return flight_.station(); }
    /// Totals of each UHF link so far.
    std::vector<archive::LinkTotals> link_totals() const;
    /// See telemetry::RecordingProgress::fraction.
    double recording_progress() const { return flight_.recording_progress(); }
    std::uint64_t seed() const { return seed_; }
    std::uint64_t cycles() const { return cycles_; }

    // ---- the score ---------------------------------------------------------------------------------------------
    const std::vector<simulation::TruthEvent>& events() const { return events_; }
    const std::vector<RecordedFiring>& firings() const { return firings_.all(); }
    ToneScore::Figures tones() const { return tones_.figures(); }
    /// Compares real time with the recording as received or, without touchdown, as stored in NVM.
    telemetry::Proof proof() const;
    /// The data products that ground assembled from both paths.
    const telemetry::ProductAssembler& products() const { return products_; }
    /// The task times of the prime computer in the test venue "performance"; else none.
    std::optional<MeasuredTimes> task_times() const {
        return executive_ ? std::optional{executive_->times()} : std::nullopt;
    }

  private:
    bool takes_commands() const {
        return scenario_.test_venue != simulation::TestVenue::gnc_alone;
    }  ///< whether it has a flight computer
    Result<commands::Request> readable(const v1::CommandRequest& request, const std::string& browser,
                                       bool director) const;
    void take(telemetry::Received& received);
    void score(const simulation::CycleReport& truth, const telemetry::Received& received);
    /// Adds the cycle's recording, without measured times, which always vary; without a recording, the path flown.
    void add_to_digest(std::span<const std::uint8_t> recorded);
    void note_product(telemetry::ReceivedPacket& packet);

    simulation::Scenario scenario_;
    const dictionary::Dictionary& dictionary_;
    std::uint64_t seed_ = 0, case_number_ = 0;
    ScriptedLanding flight_;
    std::shared_ptr<ThreadedExecutive> executive_;  ///< in the venue "performance"
    Digest digest_;
    std::uint64_t cycles_ = 0;
    std::string broken_;  ///< the failed check in the simulation

    const dictionary::Packet* product_packet_ = nullptr;
    std::vector<simulation::TruthEvent> events_;
    RecordedFirings firings_;
    ToneScore tones_;
    telemetry::PacketRegister register_;
    telemetry::ProductAssembler products_;
    telemetry::Received nothing_;
};

}  // namespace aeolis::server
