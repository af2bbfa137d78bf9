// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"
#include "generated/state_machines.hpp"

namespace aeolis::flight {

/// A change of phase and its event in state_machines.csv. R38
struct PhaseChange {
    EdlPhase from{};
    EdlPhaseEvent event{};
    EdlPhase to{};
};
using PhaseChanges = FixedVector<PhaseChange, 6>;  ///< late cruise, "do edl", pre-EDL, GNC's mode, ...

/// The facts that decide the phase before GNC is enabled, from the clock and "do edl".
struct Approach {
    bool late_cruise = false;   ///< "do edl" is possible by time
    bool begun = false;         ///< "do edl" was accepted
    bool pre_edl_over = false;  ///< fault protection can no longer inhibit EDL
};

/// The vehicle's EDL phase, in the mission's terms.
/// It follows the timeline and GNC's mode, only by the transitions of state_machines.csv.
class Phase {
  public:
    EdlPhase state() const { return machine_.state(); }

    /// Updates the phase for this cycle. Returns its changes, in order.
    PhaseChanges follow(gnc::Mode mode, const gnc::Configuration& configuration, const Approach& approach);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        machine_.carry(exchange);
    }

  private:
    void take(EdlPhaseEvent event, PhaseChanges& changes);

    EdlPhaseMachine machine_;
};

}  // namespace aeolis::flight
