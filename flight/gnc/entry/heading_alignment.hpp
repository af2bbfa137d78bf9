// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/entry/target_geometry.hpp"
#include "generated/parameters.hpp"

// Heading alignment: below about 1100 m/s, bank turns the velocity towards the target.
// Range is no longer controlled.
//
//   bank = 100 · atan2(crossrange, downrange), within ±30°
//
// In       geometry of the target, crossrange positive to the right       Out   bank [rad], positive to the right
// Source   [facts] Guidance: gain 100, limit 30°, start at 1100 m/s
namespace aeolis::flight::gnc {

double heading_alignment_bank_rad(const Parameters& parameters, const TargetGeometry& geometry);

}  // namespace aeolis::flight::gnc
