// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/gnc/navigation/radar_batch.hpp"
#include "simulation/landing.hpp"
#include "simulation/venues/venue_timeline.hpp"

namespace aeolis::simulation {

/// As GNC takes it: angles in radians. What ground's navigators do not bring keeps GNC's own value.
flight::gnc::Solution solution_of(const NavigationSolution& from);

/// The test venue "GNC alone" (the paper's GSTS): EdlGnc and the radar's batch filter as they fly, and a few lines in
/// place of the timeline. Nothing of executive, telemetry, commands or radio takes part. R36
///
/// In       DeviceInputs of each tick                     Out   DeviceOutputs of that cycle, what GNC told
/// Rate     64 Hz        Memory   a value: copying it is a fork
class GncAlone {
  public:
    GncAlone(const flight::Load& load, const NavigationSolution& solution, Sclk now);

    /// What goes out to the devices, until the next.
    const flight::DeviceOutputs& cycle(const flight::DeviceInputs& in);

    void shift_navigation(const flight::NavigationShift& by) { gnc_.shift_navigation(by); }

    const flight::gnc::Output& told() const { return told_; }
    const flight::gnc::Configuration& configuration() const { return timeline_.configuration(); }
    const flight::gnc::EdlGnc& gnc() const { return gnc_; }

  private:
    flight::gnc::EdlGnc gnc_;
    flight::gnc::RadarBatch batch_;
    flight::gnc::Output told_;
    flight::DeviceOutputs out_;
    VenueTimeline timeline_;
};

/// The name of what GNC decided, among those in decided_on_board; none for what the truth shows by itself.
const char* decided_by_gnc(flight::gnc::Trigger trigger);

}  // namespace aeolis::simulation
