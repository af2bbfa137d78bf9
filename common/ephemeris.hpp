// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris_time.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace aeolis {

// Trajectories and attitudes as the field exchanges them: CCSDS messages (common/navigation_message.hpp) and SPICE
// kernels (common/spk.hpp, common/ck.hpp).

/// Position [km] and velocity [km/s] of a body.
struct EphemerisState {
    EphemerisTime time;
    std::array<double, 3> position_km{}, velocity_kmps{};
};

enum class Interpolation : std::uint8_t { hermite, lagrange };

/// States of one body relative to a centre, in one frame, over one span of time.
struct Ephemeris {
    std::string object, object_id, centre, frame;  ///< as the file names them: "MSL", "-76", "MARS", "EME2000"
    Interpolation interpolation = Interpolation::hermite;
    std::size_t degree = 7;              ///< of the polynomial; of Hermite odd
    EphemerisTime start, stop;           ///< of what may be used: within the first and last state
    std::vector<EphemerisState> states;  ///< times ascend
};

/// State at an instant. Hermite: position by positions and velocities, velocity as its derivative. Lagrange: each by
/// itself.
/// From the states about it, fewer where there are no more. None outside start … stop.
std::optional<EphemerisState> state_at(const Ephemeris& ephemeris, EphemerisTime time);

/// Attitude: the rotation that turns components in frame A into components in frame B, and B's angular velocity.
struct AttitudeState {
    EphemerisTime time;
    std::array<double, 4> q_BA{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z; the standard's own, which turns axes, is conjugate
    std::optional<std::array<double, 3>> w_AB_B_rps;  ///< of B in A, components in B [rad/s]
};

struct AttitudeHistory {
    std::string object, object_id, centre, frame_a, frame_b;
    EphemerisTime start, stop;
    std::vector<AttitudeState> states;  ///< times ascend
};

/// Attitude at an instant: the two neighbours joined by a rotation about one axis. None outside start … stop.
std::optional<AttitudeState> attitude_at(const AttitudeHistory& history, EphemerisTime time);

}  // namespace aeolis
