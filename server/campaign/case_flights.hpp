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

namespace aeolis::server::campaign {

/// The landings of a campaign: what all cases have in common is flown once, and each case is a copy of it.
///
/// In       the number of a case                        Out   what is kept of it; none when it was abandoned
/// Rate     as fast as it is called; from several threads at once
/// Memory   a landing with its recording a thread, some ten megabytes; nothing stays of a case
/// Faults   a bug found in the simulation, or what else it throws, ends that case as lost
/// Case K is, bit for bit, the landing that `aeolis rehearse --case K` flies; what nobody reads (relay, proof, data
/// products, what channels say once the script is sent) is left out.
class CaseFlights {
  public:
    /// Flies up to the moment of dispersion; nothing when the scenario has none of its own. The dictionary must outlive
    /// this.
    CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed, const dictionary::Dictionary& dictionary);
    /// Once `abandon` is set, whatever flies ends with its next cycle. It must outlive this, too.
    CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed, const dictionary::Dictionary& dictionary,
                const std::atomic<bool>& abandon);

    std::optional<CaseResult> fly(std::uint64_t case_number) const;

  private:
    /// A landing on its way, and what it has told so far.
    struct Flight {
        ScriptedLanding landing;
        RecordedFirings firings;
        std::vector<CaseEvent> events;
        std::uint64_t cycles = 0;

        void step();
    };
    std::unique_ptr<Flight> begun(std::uint64_t case_number) const;
    void summarise(const Flight& flight, CaseResult& result) const;

    simulation::Scenario scenario_;
    std::uint64_t seed_;
    const dictionary::Dictionary& dictionary_;
    const std::atomic<bool>& abandon_;
    std::unique_ptr<const Flight> common_;  ///< none: each case is flown from the start
};

/// Of each timepoint at which the timeline passes from one anchor to the next, and that was fired after `after_sclk`,
/// how long after its minimum offset permitted it was it triggered: nought is one that the timeline held up. Within an
/// anchor's own sequence the margins are the timeline's design and say nothing of the case. Minimum offsets are the
/// dictionary's.
std::vector<TimelineMargin> timeline_margins(const std::vector<RecordedFiring>& firings,
                                             const dictionary::Dictionary& dictionary, double after_sclk);

}  // namespace aeolis::server::campaign
