// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis::telemetry {

/// The smallest length ≥ `least` and ≥ 8 without prime factors above 5, for which the Fourier transform is fast.
int smooth_length(int least);

/// Peak of a parabola through three equidistant values, in steps from the middle one: −0.5 … 0.5; 0 without a peak.
double peak_offset(double before, double at, double after);

}  // namespace aeolis::telemetry
