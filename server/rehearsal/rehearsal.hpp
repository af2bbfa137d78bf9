// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/rehearsal/digest.hpp"
#include "server/rehearsal/recorded_firings.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/rehearsal/tone_score.hpp"
#include "server/venue/threaded_executive.hpp"
#include "simulation/landing.hpp"
#include "telemetry/product_assembler.hpp"
#include "telemetry/proof.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

/// One run: the landing, its command path, its script, and what is summed up over it. No thread, no clock, no disk.
///
/// In       cycles to step; commands                    Out   what ground received; stages of commands; the score
/// Rate     as fast as it is called                     Memory   the recording and its register: some tens of megabytes
/// Faults   a bug found in the simulation ends the run as lost, with the broken condition as reason
class Rehearsal {
  public:
    /// The dictionary must outlive this. A `runner` takes the place of the prime computer's executive; a `clock` is
    /// that of a run which was begun before.
    Rehearsal(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
              const dictionary::Dictionary& dictionary, std::shared_ptr<flight::CycleRunner> runner = {},
              const std::optional<ClockCorrelation>& clock = {});

    /// One cycle of 1/64 s, after the script's commands that are due. What was received stands until the next step.
    const telemetry::Received& step();

    v1::CommandReply submit(const v1::CommandRequest& request, const std::string& browser = {});
    /// See commands::CommandGateway::look.
    std::vector<v1::CommandReply> look(std::span<const v1::CommandRequest> file);
    /// See commands::CommandGateway::judge.
    Result<void> judge(const commands::TimelineVerdict& verdict) { return flight_.judge(verdict); }

    /// It begins with the next cycle. An Error names what of it cannot be.
    Result<void> inject(const v1::FaultInjection& injection);

    /// Stages since the last call; their `seq` is not given yet.
    std::vector<archive::StageRecord> take_stages();
    /// Reasons for which commands of the scenario's own script were refused.
    const std::vector<std::string>& script_refusals() const { return flight_.script_refusals(); }

    bool finished() const { return !broken_.empty() || landing().finished(); }
    std::string outcome() const;  ///< running, touchdown, impact, lost, not_commanded, timeout
    std::string outcome_reason() const;
    std::string digest() const { return digest_.text(); }

    archive::RunStart run_start(double pace) const;
    v1::Clocks clocks() const;

    const simulation::Scenario& scenario() const { return scenario_; }
    const simulation::Landing& landing() const { return flight_.landing(); }
    const commands::CommandGateway& gateway() const { return flight_.gateway(); }
    const telemetry::GroundStation& station() const { return flight_.station(); }
    /// What each UHF link has brought so far.
    std::vector<archive::LinkTotals> link_totals() const;
    double recording_progress() const { return flight_.recording_progress(); }  ///< 0 … 1 that has come down
    std::uint64_t seed() const { return seed_; }
    std::uint64_t cycles() const { return cycles_; }

    // ---- the score ---------------------------------------------------------------------------------------------
    const std::vector<simulation::TruthEvent>& events() const { return events_; }
    const std::vector<RecordedFiring>& firings() const { return firings_.all(); }
    ToneScore::Figures tones() const { return tones_.figures(); }
    /// Real time against the recording: as it came down; when none comes (no touchdown), as it lies in NVM.
    telemetry::Proof proof() const;
    /// Data products as ground put them together from what came, real time or recording.
    const telemetry::ProductAssembler& products() const { return products_; }
    /// In the test venue "performance": what the tasks of the prime computer took. Else none.
    std::optional<MeasuredTimes> task_times() const {
        return executive_ ? std::optional{executive_->times()} : std::nullopt;
    }

  private:
    bool takes_commands() const {
        return scenario_.test_venue != simulation::TestVenue::gnc_alone;
    }  ///< it has a computer
    void take(const telemetry::Received& received);
    void score(const simulation::CycleReport& truth, const telemetry::Received& received);
    /// What the run recorded, but for measured times, which are never alike; where nothing is recorded the path flown.
    void add_to_digest(std::span<const std::uint8_t> recorded);
    void note_product(std::span<const std::uint8_t> packet);

    simulation::Scenario scenario_;
    const dictionary::Dictionary& dictionary_;
    std::uint64_t seed_ = 0, case_number_ = 0;
    ScriptedLanding flight_;
    std::shared_ptr<ThreadedExecutive> executive_;  ///< of the venue "performance"
    Digest digest_;
    std::uint64_t cycles_ = 0;
    std::string broken_;  ///< the condition that failed in the simulation

    const dictionary::Packet* product_packet_ = nullptr;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    std::vector<simulation::TruthEvent> events_;
    RecordedFirings firings_;
    ToneScore tones_;
    telemetry::UnitRegister units_;
    telemetry::ProductAssembler products_;
    telemetry::Received nothing_;
};

}  // namespace aeolis::server
