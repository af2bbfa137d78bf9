// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/load.hpp"
#include "generated/parameters.hpp"

#include <cstdint>

// Range control by Apollo's final-phase guidance: the part of lift to point up to reach the target.
//
//   R_p   = R_ref + ∂R/∂D (D − D_ref) + ∂R/∂ḣ (ḣ − ḣ_ref)                        all functions of V, from the reference
//   (L/D)v = (L/D)_ref + K (R − R_p) / (∂R/∂(L/D))
//   |bank| = acos( (L/D)v / (L/D) )
//
// In       V, D, ḣ relative to rotating Mars; R range to go; L/D as sensed       Out   vertical L/D and |bank|
// Rate     64 Hz         Memory   none: a pure function of the reference
// Source   [apollo-entry-guidance]; K from parameters.csv
// Valid    within the reference's velocities; held at its ends
namespace aeolis::flight::gnc {

/// The reference at a velocity, linear between its rows, held at its ends.
/// An empty reference gives a row of zeros.
EntryReferenceRow reference_at(const EntryReference& reference, double velocity_mps);

struct RangeControlInput {
    double velocity_mps = 0.0;
    double drag_mps2 = 0.0;
    double altitude_rate_mps = 0.0;
    double range_to_go_m = 0.0;
    double lift_to_drag = 0.0;
};

struct RangeControlOutput {
    double predicted_range_m = 0.0;
    double vertical_lift_to_drag = 0.0;  ///< wanted, before the limit of the available lift
    double bank_magnitude_rad = 0.0;     ///< 0 … π
    bool saturated = false;              ///< lift nearly full up or down: no margin left to control range
};

RangeControlOutput range_control(const Parameters& parameters, const EntryReference& reference,
                                 const RangeControlInput& input);

}  // namespace aeolis::flight::gnc
