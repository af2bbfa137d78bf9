// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"
#include "generated/state_machines.hpp"

namespace aeolis::flight {

/// The vehicle's EDL phase, in the mission's terms.
/// It follows the timeline and GNC's mode, only by the transitions of state_machines.csv.
class Phase {
  public:
    EdlPhase state() const { return machine_.state(); }

    /// Updates the phase for this cycle. True when it changed.
    bool follow(gnc::Mode mode, const gnc::Configuration& configuration, bool late_cruise);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        machine_.carry(exchange);
    }

  private:
    EdlPhaseMachine machine_;
};

}  // namespace aeolis::flight
