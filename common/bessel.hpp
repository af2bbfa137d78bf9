// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis {

/// Natural logarithm of the modified Bessel function I0, x ≥ 0, within 1e-7. [abramowitz-stegun] 9.6.12, 9.7.1
double log_bessel_i0(double x);

}  // namespace aeolis
