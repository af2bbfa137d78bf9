// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/devices/load.hpp"
#include "simulation/venues/gnc_stand_in.hpp"
#include "simulation/venues/venue_timeline.hpp"
#include "simulation/world.hpp"

#include <bit>
#include <map>
#include <string>

namespace aeolis::tests {

/// Lands the world without any flight software, by a stand-in for GNC and a few lines in place of the timeline. It
/// flies the models through a whole landing.
class TruthPilot {
  public:
    explicit TruthPilot(const simulation::Scenario& scenario, std::uint64_t seed = 1, std::uint64_t case_number = 0)
        : world(scenario, seed, case_number), gnc_(simulation::load_for(scenario)), timeline_(world.solution().entry) {}

    simulation::World world;
    FixedVector<flight::ImuSample, 4> imu;  ///< that came with the tick of the last step
    std::map<std::string, simulation::TruthEvent> events;
    std::uint64_t digest = 0xcbf29ce484222325ULL;

    void run() {
        while (world.outcome() == simulation::Outcome::running) step();
    }
    void run_until(double e_s) {
        while (world.outcome() == simulation::Outcome::running && world.truth().e_s < e_s) step();
    }
    void step() {
        const flight::DeviceInputs& in = world.sense();
        imu = in.imu;
        for (const auto& sample : in.imu) add(sample.delta_v_mps), add(sample.delta_angle_rad);
        for (const auto& beam : in.radar) add({beam.range_m, beam.range_rate_mps, 0.0});
        add(world.truth().p_MoB_M_m);
        out_.begin_cycle();
        timeline_.act(in.now, out_);
        const flight::gnc::Output& told = gnc_.cycle(world, timeline_.configuration());
        timeline_.take(told, in.now);
        timeline_.act(in.now, out_);
        out_.thrusters = told.thrusters;
        out_.engines = told.engines;
        world.advance(out_);
        for (const auto& event : world.events()) events.emplace(event.name, event);
    }

  private:
    void add(const std::array<double, 3>& values) {
        for (const double value : values) digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3ULL;
    }

    simulation::GncStandIn gnc_;
    simulation::VenueTimeline timeline_;
    flight::DeviceOutputs out_;
};

}  // namespace aeolis::tests
