// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/height_grid.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <memory>

namespace aeolis::simulation {

/// The ground around the target: the sphere of the landing radius, raised by a height and tilted by an even slope, and
/// on it the scenario's grid of heights and a case's roughness, if it has them.
///
/// Left out: rocks, and all that is smaller than a cell of the grid or of the roughness.
/// Frame M        Valid within 30 km of the target: there a tilted plane and a tilted sphere differ by a percent of the
///                slope
class Terrain {
  public:
    /// `random` draws the case's own height, slope and roughness.
    Terrain(const Scenario& scenario, Random random);

    /// Height over the landing radius, as tables of the air and reports use it. [m]
    double altitude_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - landing_radius_m_; }
    /// Radius of the ground below `p_MoB_M`, from Mars's centre. [m]
    double radius_m(const Vector3& p_MoB_M) const;
    /// Height over the ground, along the radius. [m]
    double height_m(const Vector3& p_MoB_M) const { return p_MoB_M.norm() - radius_m(p_MoB_M); }
    /// Unit normal of the ground there, pointing away from it.
    Vector3 normal(const Vector3& p_MoB_M) const;

    /// Whether the ground below is that of the scenario, and not the edge of its grid that goes on.
    bool is_known(const Vector3& p_MoB_M) const {
        return !grid_ || grid_->holds(from_target_m(p_MoB_M, east_M_), from_target_m(p_MoB_M, north_M_));
    }

    /// The first point where a ray from `p_MoB_M` along the unit vector `direction_M` meets the ground. Ground that is
    /// even is taken as the sphere that touches it below the start.
    struct Meeting {
        bool meets = false;
        double range_m = 0.0;
        double incidence_cosine = 0.0;  ///< between the reversed ray and the normal
    };
    Meeting meet(const Vector3& p_MoB_M, const Vector3& direction_M) const;

    double height_at_target_m() const { return height_m_; }
    const Vector3& rise_M() const { return rise_M_; }

  private:
    Meeting meet_uneven(const Vector3& p_MoB_M, const Vector3& direction_M) const;
    bool is_uneven() const { return grid_ || tile_; }
    /// Of grid and roughness together, at metres from the target.
    double uneven_m(double east_m, double north_m) const;
    HeightGrid::Rise uneven_rise(double east_m, double north_m) const;
    /// Metres from the target along `axis_M`, which is horizontal there.
    double from_target_m(const Vector3& p_MoB_M, const Vector3& axis_M) const {
        return landing_radius_m_ * p_MoB_M.dot(axis_M) / p_MoB_M.norm();
    }

    double landing_radius_m_;
    double height_m_;
    Vector3 rise_M_;  ///< horizontal at the target, uphill; its length is the tangent of the slope
    std::shared_ptr<const HeightGrid> grid_, tile_;  ///< tile: of the roughness
    Vector3 east_M_, north_M_;                       ///< at the target
};

}  // namespace aeolis::simulation
