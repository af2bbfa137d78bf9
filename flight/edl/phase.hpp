// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"
#include "generated/state_machines.hpp"

namespace aeolis::flight {

/// The state of the vehicle in the words of the mission: it follows what the timeline did and the mode that GNC is in,
/// by the transitions of state_machines.csv and no others.
class Phase {
  public:
    EdlPhase state() const { return machine_.state(); }

    /// As things stand in this cycle. True when the phase changed.
    bool follow(gnc::Mode mode, const gnc::Configuration& configuration, bool late_cruise);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        machine_.carry(exchange);
    }

  private:
    EdlPhaseMachine machine_;
};

}  // namespace aeolis::flight
