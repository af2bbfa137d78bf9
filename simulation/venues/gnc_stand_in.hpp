// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "simulation/world.hpp"

#include <array>
#include <optional>

namespace aeolis::simulation {

/// Stand-in for GNC in the test venue "all but GNC": looks at the truth and lands by a few rules of thumb.
///
/// It has no navigation and no guidance. Its outputs are those of EdlGnc, so that everything behind EdlGnc can be
/// tested without it. R36
/// In       the world, the timeline's actions         Out   gnc::Output of a cycle
/// Rate     64 Hz        Memory   a value: copying it is a fork
/// Source   bank history roughly [od137]; the rest is our assumption
class GncStandIn {
  public:
    explicit GncStandIn(const flight::Load& load) : load_(load), steering_(load.engine_max_thrust_N) {}

    const flight::gnc::Output& cycle(const World& world, const flight::gnc::Configuration& configuration);

  private:
    void follow(const flight::gnc::Configuration& configuration);
    void decide_in_air(const World& world, const flight::gnc::Configuration& configuration);
    void decide_on_engines(const World& world, const flight::gnc::Configuration& configuration);
    void guide(const World& world, const flight::gnc::Configuration& configuration);
    void steer(const World& world, const flight::gnc::Configuration& configuration);
    void report(const World& world);
    bool take(flight::GncModeEvent event);
    bool fire(flight::gnc::Trigger trigger, const flight::gnc::Condition& condition);
    bool fired(flight::gnc::Trigger trigger) const { return fired_[static_cast<std::size_t>(trigger)]; }

    flight::Load load_;
    flight::GncModeMachine mode_;
    Sclk now_, mode_since_;
    std::array<bool, flight::gnc::trigger_count> fired_{};
    int reversals_ = 0;
    flight::gnc::Steering steering_;
    flight::gnc::Output told_;
};

}  // namespace aeolis::simulation
