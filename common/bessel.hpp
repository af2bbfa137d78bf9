// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis {

/// Natural logarithm of the modified Bessel function I0, for x ≥ 0. Below x = 20 by the series 9.6.12 of
/// [abramowitz-stegun], from there by the asymptotic one, 9.7.1. Rounding apart, the absolute error is below 1e-6, and
/// largest at x = 20.
double log_bessel_i0(double x);

}  // namespace aeolis
