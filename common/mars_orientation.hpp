// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris_time.hpp"

#include <array>

namespace aeolis {

using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< rows

/// How Mars is turned: its pole, prime meridian and spin [iau-mars], as SPICE's IAU_MARS has them.
///
/// Turns components in J2000 (EME2000) into components in M, Mars's own frame (docs/frames_and_units.md).
Matrix3 mars_from_j2000(EphemerisTime time);
inline constexpr double mars_spin_degpday = 350.89198226;

/// A state relative to rotating Mars from one relative to J2000's axes, and back. Any unit of length, seconds.
struct PositionAndVelocity {
    std::array<double, 3> position{}, velocity{};
};
PositionAndVelocity to_mars_fixed(const PositionAndVelocity& inertial, EphemerisTime time);
PositionAndVelocity to_j2000(const PositionAndVelocity& mars_fixed, EphemerisTime time);

}  // namespace aeolis
