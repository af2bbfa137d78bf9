// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis::telemetry {

/// Least length ≥ `least` and ≥ 8 without prime factors above 5: what the Fourier transform is fast for.
int smooth_length(int least);

/// Where a parabola through three equidistant values has its peak, in steps from the middle one: −0.5 … 0.5; 0 without
/// a peak.
double peak_offset(double before, double at, double after);

}  // namespace aeolis::telemetry
