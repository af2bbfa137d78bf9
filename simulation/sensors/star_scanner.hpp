// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// Cruise attitude determination: the attitude once a second while the cruise stage, which carries it, is attached.
///
/// A case has one constant error, a small rotation in B with the scenario's deviation on each axis, beside what the
/// scenario says of it.
class StarScanner {
  public:
    StarScanner(const Scenario& scenario, Random random)
        : error_(rotation(scenario.dispersions.attitude_rad * vector3(random.normal3()) + believed_rad(scenario))) {}

    flight::CruiseAttitude measure(const Quaternion& q_MB, Sclk now) const {
        const Quaternion measured = (q_MB * error_).normalized();
        return {array4(measured), now};
    }

    const Quaternion& error() const { return error_; }

  private:
    static Vector3 believed_rad(const Scenario& scenario) {
        if (!scenario.believed) return Vector3::Zero();
        const Belief& belief = *scenario.believed;
        return degree_rad * Vector3{belief.attitude_x_deg, belief.attitude_y_deg, belief.attitude_z_deg};
    }

    Quaternion error_;
};

}  // namespace aeolis::simulation
