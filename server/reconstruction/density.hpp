// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/reconstruction/path.hpp"

#include <vector>

// Density of the air along a rebuilt path, from the drag that the IMU felt:
//
//   ρ = 2 m a_D / (C_D(Mach, α) · S · V²)        a_D = −f·V/|V|
//
// Source   the field's practice for entry capsules without pressure ports [karlgaard-2013]; C_D is common/aeroshell
// Left out wind: it is part of the uncertainty. Mach is by the speed of sound of the planned atmosphere
namespace aeolis::reconstruction {

/// One standard deviation of what ground does not know of vehicle and air. [facts] Dispersed landings, a third of each.
struct DensityErrors {
    double fast_drag_fraction = 0.01;   ///< of the drag coefficient, above Mach 8
    double slow_drag_fraction = 0.033;  ///< the same, below Mach 3
    double mass_fraction = 0.001;
    double wind_mps = 7.0;    ///< of each horizontal component
    double felt_mps2 = 0.02;  ///< thrusters' pulses and the place of the IMU. Our assumption
    /// Slower than this it may be the parachute that is felt, where its deployment is not in the recording. Our
    /// assumption: it opens below 2.2.
    double parachute_possible_mach = 2.3;
    double sigma_fraction_max = 0.3;  ///< where less is known, nothing is said. Our assumption
};

/// The entry vehicle as ground knows it: the design of 2012, unless the run's scenario believes another. [facts]
struct KnownVehicle {
    double entry_mass_kg = 3153.0;
    double balance_each_kg = 25.0;
    /// Drag by that of common/aeroshell, by Mach number: linear between rows, held outside them; none: 1.
    struct DragScale {
        double mach = 0.0, factor = 1.0;
    };
    std::vector<DragScale> drag_scale{};
};

struct DensityPoint {
    Sclk at;
    double altitude_m = 0.0;  ///< above the landing radius
    double density_kgm3 = 0.0;
    double sigma_kgm3 = 0.0;
    double mach = 0.0;
};

/// The density along the path of the entry vehicle, from where the air is felt to the parachute's deployment,
/// or to where it may have been deployed if the recording does not tell.
///
/// Each point lies in the middle of a step of the path. Of the recording it takes when the balance masses went and when
/// the parachute was deployed.
std::vector<DensityPoint> density_along(const Path& path, const RecordedLanding& recorded,
                                        const KnownVehicle& vehicle = {}, const DensityErrors& errors = {});

}  // namespace aeolis::reconstruction
