#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "generated/dictionary_flight.hpp"

namespace aeolis::flight {

/// The state of the vehicle in the words of the mission: from what the timeline did and the mode that GNC is in.
EdlPhase phase_of(gnc::Mode mode, const gnc::Configuration& configuration, bool late_cruise);

}  // namespace aeolis::flight
