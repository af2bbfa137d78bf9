// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/gnc/navigation/radar_batch.hpp"
#include "simulation/landing.hpp"
#include "simulation/venues/venue_timeline.hpp"

namespace aeolis::simulation {

/// Ground's solution in the form that GNC takes: angles in radians. Fields that ground lacks keep GNC's own values.
flight::gnc::Solution solution_of(const NavigationSolution& from);

/// The test venue "GNC alone" (the paper's GSTS): EdlGnc and the radar's batch filter as flown, with a few lines in
/// place of the timeline.
///
/// Executive, telemetry, commands and radio take no part. R36
/// In       DeviceInputs of each tick                     Out   DeviceOutputs of that cycle, GNC's output
/// Rate     64 Hz        Memory   a value: copying it is a fork
class GncAlone {
  public:
    GncAlone(const flight::Load& load, const NavigationSolution& solution, Sclk now);

    /// Runs one cycle; returns the outputs to the devices, valid until the next call.
    const flight::DeviceOutputs& cycle(const flight::DeviceInputs& in);

    void shift_navigation(const flight::NavigationShift& by) { gnc_.shift_navigation(by); }

    const flight::gnc::Output& told() const { return told_; }
    const flight::gnc::Configuration& configuration() const { return timeline_.configuration(); }
    const flight::gnc::EdlGnc& gnc() const { return gnc_; }

  private:
    flight::Parameters parameters_;
    flight::gnc::EdlGnc gnc_;
    flight::gnc::RadarBatch batch_;
    flight::gnc::Output told_;
    flight::DeviceOutputs out_;
    VenueTimeline timeline_;
};

/// The name in decided_on_board of a GNC decision; null when the truth shows it by itself.
const char* decided_by_gnc(flight::gnc::Trigger trigger);

}  // namespace aeolis::simulation
