// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The disk-gap-band parachute: when it opens after the mortar, and its drag area with the vehicle under it.
///
/// Times from the published flight: line stretch 1.12 s after the mortar, first peak 1.8 s after. [od137]
/// The factor by Mach and the overshoot at inflation are ours, chosen so that the published trajectory's deceleration
/// comes out: drag area over its terminal value 1.27 at Mach 1.6, dip at Mach 1, 315 m² at the first peak.
inline constexpr double line_stretch_s = 1.12;
inline constexpr double first_peak_s = 1.8;

/// 0 until line stretch, above 1 at the first peak, then 1.
double parachute_inflation(double since_mortar_s);

/// The bridles' confluence, where the riser pulls, along z from the descent stage's centre of mass: about 2 m behind
/// that of all that hangs on it. Ours.
inline constexpr double riser_station_m = -1.9;
/// What friction in bridles and risers takes from the vehicle's swing below the confluence (wrist mode). [N m s] Ours.
inline constexpr double wrist_damping_Nms = 900.0;

/// The parachute trims beside the wind and so lifts too: what the published trajectory shows, 0.15 when it opens, 0.13
/// … 0.21 later [od137].
inline constexpr double parachute_lift_to_drag = 0.17;
/// Level, to the right of a flight; south of one that falls straight down.
Vector3 level_right(const Vector3& p_MoB_M, const Vector3& v_MB_M);
/// Unit, across `forward`: up when the parachute opens, as the vehicle flew lift up, then turning about the wind to the
/// right. `from_up_rad` is a case's own departure. `right_M` is level, to the right of the flight at the mortar.
/// [od137] until 15 s after; that it goes on evenly is ours.
Vector3 parachute_lift_direction(const Vector3& forward, const Vector3& right_M, double since_mortar_s,
                                 double from_up_rad = 0.0);

/// Drag area relative to that at terminal speed.
double parachute_mach_factor(double mach);

}  // namespace aeolis::simulation
