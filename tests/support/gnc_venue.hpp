// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/devices/load.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/world.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::tests {

/// The test venue "GNC alone" without links, open for inspection.
class GncVenue {
  public:
    /// A trigger of GNC or a bank reversal, with GNC's output and the truth at that moment.
    struct Event {
        std::optional<flight::gnc::Trigger> trigger;
        std::uint8_t reversal = 0;
        flight::gnc::Output told;
        simulation::TruthState truth;
        simulation::World::Inspection seen;
    };

    GncVenue(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0)
        : world_(scenario, seed, case_number),
          alone_(simulation::load_for(scenario), world_.solution(), world_.sclk()) {}

    bool running() const { return world_.outcome() == simulation::Outcome::running; }

    void step() {
        inputs_ = world_.sense();
        const flight::DeviceOutputs& commands = alone_.cycle(inputs_);
        for (const auto& one : told().triggers)
            events_.push_back({one.trigger, 0, told(), world_.truth(), world_.inspect()});
        if (told().bank_reversal.number != 0)
            events_.push_back({std::nullopt, told().bank_reversal.number, told(), world_.truth(), world_.inspect()});
        world_.advance(commands);
    }

    void run() {
        while (running()) step();
    }

    const simulation::World& world() const { return world_; }
    const flight::gnc::EdlGnc& gnc() const { return alone_.gnc(); }
    const flight::gnc::Output& told() const { return alone_.told(); }
    const flight::gnc::Configuration& configuration() const { return alone_.configuration(); }
    const flight::DeviceInputs& last_inputs() const { return inputs_; }
    const std::vector<Event>& events() const { return events_; }
    const Event* event(flight::gnc::Trigger trigger) const {
        for (const Event& event : events_)
            if (event.trigger == trigger) return &event;
        return nullptr;
    }

  private:
    simulation::World world_;
    simulation::GncAlone alone_;
    flight::DeviceInputs inputs_;
    std::vector<Event> events_;
};

}  // namespace aeolis::tests
