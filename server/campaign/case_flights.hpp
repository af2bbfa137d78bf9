// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/campaign/case_result.hpp"
#include "server/rehearsal/recorded_firings.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "simulation/scenario.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace aeolis::server::campaign {

/// The result of a landing that has ended. Margins are of timepoints that fired after `from_sclk`.
CaseResult result_of(const simulation::Landing& landing, const RecordedFirings& firings,
                     std::span<const simulation::TruthEvent> events, const simulation::Scenario& scenario,
                     const dictionary::Dictionary& dictionary, double from_sclk);

/// Flies the cases of a campaign. The part common to all cases is flown once; each case starts from a copy of it.
///
/// In       the number of a case                        Out   its result; none when it was abandoned
/// Rate     as fast as it is called; from several threads at once
/// Memory   one landing with its recording per thread, about ten megabytes; nothing remains of a finished case
/// Faults   a failed check or an exception in the simulation ends that case as lost
///
/// Case K is bit for bit the landing that `aeolis rehearse --case K` flies. Parts without a reader are left out: relay,
/// proof, data products, and channel values once the script is sent.
class CaseFlights {
  public:
    /// Flies up to the moment of dispersion, if the scenario has one. The dictionary must outlive this.
    CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed, const dictionary::Dictionary& dictionary);
    /// Once `abandon` is set, each case ends with its next cycle. `abandon` must outlive this too.
    CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed, const dictionary::Dictionary& dictionary,
                const std::atomic<bool>& abandon);

    std::optional<CaseResult> fly(std::uint64_t case_number) const;

  private:
    /// A landing in flight, and what was recorded of it so far.
    struct Flight {
        ScriptedLanding landing;
        RecordedFirings firings;
        std::vector<simulation::TruthEvent> events;
        std::uint64_t cycles = 0;

        void step();
    };
    std::unique_ptr<Flight> begun(std::uint64_t case_number) const;

    simulation::Scenario scenario_;
    std::uint64_t seed_;
    const dictionary::Dictionary& dictionary_;
    const std::atomic<bool>& abandon_;
    std::unique_ptr<const Flight> common_;  ///< null: each case is flown from its start
};

}  // namespace aeolis::server::campaign
