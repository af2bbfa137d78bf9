// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/point_mass.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::simulation {

/// The ground around the target: the sphere of the landing radius, raised by a height and tilted by an even slope.
///
/// Left out: rocks, craters and all real terrain.
/// Frame M        Valid within 30 km of the target: there a tilted plane and a tilted sphere differ by a percent of the
///                slope
class Terrain {
  public:
    /// `random` draws the case's own height and slope.
    Terrain(const Scenario& scenario, Random random);

    /// Height over the landing radius, as tables of the air and reports use it. [m]
    double altitude_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - landing_radius_m_; }
    /// Radius of the ground below `p_MoB_M`, from Mars's centre. [m]
    double radius_m(const Vector3& p_MoB_M) const;
    /// Height over the ground, along the radius. [m]
    double height_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - radius_m(p_MoB_M); }
    /// Unit normal of the ground there, pointing away from it.
    Vector3 normal(const Vector3& p_MoB_M) const;

    /// The point where a ray from `p_MoB_M` along the unit vector `direction_M` meets the ground. The ground is taken
    /// as the sphere that touches it below the start.
    struct Meeting {
        bool meets = false;
        double range_m = 0.0;
        double incidence_cosine = 0.0;  ///< between the reversed ray and the normal
    };
    Meeting meet(const Vector3& p_MoB_M, const Vector3& direction_M) const;

    double height_at_target_m() const { return height_m_; }
    const Vector3& rise_M() const { return rise_M_; }

  private:
    double landing_radius_m_;
    double height_m_;
    Vector3 rise_M_;  ///< horizontal at the target, uphill; its length is the tangent of the slope
};

}  // namespace aeolis::simulation
