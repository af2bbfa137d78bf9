// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/mars/atmosphere.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/mars/terrain.hpp"
#include "simulation/mars/wind.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace aeolis::simulation {

/// Lift of the parachute that a body keeps: the plane goes on turning as before, see parachute_lift_direction.
struct ParachuteLift {
    Vector3 right_at_mortar_M = Vector3::UnitZ();
    double since_mortar_s = 0.0;  ///< at the release
    double from_up_rad = 0.0;
    double by_drag = 0.0;  ///< lift over drag
};

/// A jettisoned body: a point with drag in the vehicle's air and wind, until it lies on the ground. Below its parachute
/// it also has the parachute's lift, so that it glides on.
///
/// Also measures how close the vehicle, or the rover on its bridle, comes to it after separation.
/// Rate     a step each 1/16 s of its own time; the vehicle's position each 1/64 s           Memory   constant
/// Left out tumbling, lift without a parachute, disturbance of each other's air
class SeparatedBody {
  public:
    /// It is clear of the vehicle at `clear_m`. It has struck the vehicle when it comes within `size_m` after that, or
    /// is not clear within `clear_within_s`.
    SeparatedBody(double size_m, double clear_m) : size_m_(size_m), clear_m_(clear_m) {}

    /// Releases the body with the state `at`. Call once.
    void release(const PointMass& at, double mass_kg, double drag_area_m2,
                 const std::optional<ParachuteLift>& lift = {});
    /// Advances by one tick. The vehicle is now at `p_MoB_M`; `rover`: its state while it hangs on the bridle.
    void tick(const Vector3& p_MoB_M, const std::optional<PointMass>& rover, const Atmosphere& atmosphere,
              const Wind& wind, const Terrain& terrain);

    bool released() const { return released_; }
    /// Least distance of the vehicle on its return, after clearance; none: it never came closer again.
    std::optional<double> least_m() const { return least_m_; }
    bool struck() const { return (least_m_ && *least_m_ < size_m_) || (!clear_ && since_release_s_ > clear_within_s); }
    static constexpr double clear_within_s = 10.0;  ///< our assumption
    /// State after the last step, at most 3/64 s ago.
    const PointMass& at() const { return at_; }
    /// Vector from the vehicle to its present position. [m] in M
    Vector3 from(const Vector3& p_MoB_M) const { return at_.p_MoB_M + since_step_s_ * at_.v_MB_M - p_MoB_M; }

  private:
    void fly(double step_s, const Atmosphere& atmosphere, const Wind& wind, const Terrain& terrain);

    double size_m_, clear_m_;
    double mass_kg_ = 1.0, drag_area_m2_ = 0.0;
    std::optional<ParachuteLift> lift_;
    PointMass at_;
    double since_release_s_ = 0.0, since_step_s_ = 0.0;
    bool released_ = false, down_ = false, clear_ = false;
    double distance_m_ = 0.0;
    std::optional<double> least_m_;
};

/// Jettisoned bodies that could come back to the vehicle.
///
/// Sizes are our assumptions: the heatshield is 4.5 m across; the backshell's includes the parachute's lines. So is the
/// heatshield's drag area: broadside, with the drag of the entry vehicle below Mach 1.
struct SeparatedBodies {
    SeparatedBody heatshield{5.0, 15.0};
    SeparatedBody backshell{10.0, 40.0};
};
inline constexpr double heatshield_drag_area_m2 = 17.0;

}  // namespace aeolis::simulation
