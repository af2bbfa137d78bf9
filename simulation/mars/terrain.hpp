// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/point_mass.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::simulation {

/// The ground around the target: the sphere of the landing radius, raised by a height and tilted by a slope that goes
/// on evenly in one direction. Without either it is that sphere. Rocks, craters and all of the real ground are left
/// out.
///
/// Frame M        Valid within 30 km of the target: there a tilted plane and a tilted sphere are alike to the slope's
///                percent
class Terrain {
  public:
    /// `random` draws the case's own height and rise.
    Terrain(const Scenario& scenario, Random random);

    /// Height over the landing radius: what the tables of the air, and reports, go by. [m]
    double altitude_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - landing_radius_m_; }
    /// Distance of the ground from Mars's centre where `p_MoB_M` stands over it. [m]
    double radius_m(const Vector3& p_MoB_M) const;
    /// Height over it, along the radius. [m]
    double height_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - radius_m(p_MoB_M); }
    /// Unit, away from the ground, there.
    Vector3 normal(const Vector3& p_MoB_M) const;

    /// Where a ray from `p_MoB_M` along the unit vector `direction_M` meets the ground: the ground below the start, as
    /// the sphere that touches it there.
    struct Meeting {
        bool meets = false;
        double range_m = 0.0;
        double incidence_cosine = 0.0;  ///< between the ray, turned around, and the normal
    };
    Meeting meet(const Vector3& p_MoB_M, const Vector3& direction_M) const;

  private:
    double landing_radius_m_;
    double height_m_;
    Vector3 rise_M_;  ///< horizontal at the target, towards uphill, as long as the tangent of the slope
};

}  // namespace aeolis::simulation
