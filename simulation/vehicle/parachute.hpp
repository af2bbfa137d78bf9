// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The disk-gap-band parachute: its inflation after the mortar fires, and its drag area with the vehicle under it.
///
/// Times from the published flight: line stretch 1.12 s after the mortar, first peak 1.8 s after. [od137]
/// Our assumptions, chosen to match the published trajectory's deceleration: the factor by Mach number and the
/// overshoot at inflation. Drag area over its terminal value is 1.27 at Mach 1.6 and dips at Mach 1; it is 315 m² at
/// the first peak.
inline constexpr double line_stretch_s = 1.12;
inline constexpr double first_peak_s = 1.8;

/// 0 until line stretch, above 1 at the first peak, then 1.
double parachute_inflation(double since_mortar_s);

/// Station of the bridles' confluence, where the riser pulls, along z from the descent stage's centre of mass. About 2
/// m behind the centre of mass of everything below it. Our assumption.
inline constexpr double riser_station_m = -1.9;
/// Horizontal unit vector to the right of the flight; south for a vertical fall.
Vector3 level_right(const Vector3& p_MoB_M, const Vector3& v_MB_M);
/// Unit vector of the parachute's lift, normal to `forward`.
///
/// It points up at opening, as the vehicle flew lift up, then turns about the wind to the right. `from_up_rad` is a
/// case's departure. `right_M` is horizontal, to the right of the flight at mortar firing. [od137] until 15 s after;
/// that it continues evenly is our assumption.
Vector3 parachute_lift_direction(const Vector3& forward, const Vector3& right_M, double since_mortar_s,
                                 double from_up_rad = 0.0);

/// Drag area relative to that at terminal speed.
double parachute_mach_factor(double mach);

/// A case's swing of the drag area above Mach 1.4, in fractions of it. [facts] that it swings; two a second is our
/// assumption.
struct ParachuteOscillation {
    double fraction = 0.0;
    double phase_rad = 0.0;
    double factor(double mach, double since_mortar_s) const;
};

}  // namespace aeolis::simulation
