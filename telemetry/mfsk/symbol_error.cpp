// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/symbol_error.hpp"

#include "common/bessel.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {

double symbol_error(double energy, int tones) {
    // Simpson's rule over x = √u, whose density lies within 8 of √E. The integrand is the error itself, not 1 − error.
    constexpr int intervals = 4000;
    const double root = std::sqrt(energy);
    const double begin = std::max(root - 8.0, 0.0), step = (root + 8.0 - begin) / intervals;
    double sum = 0.0;
    for (int i = 0; i <= intervals; ++i) {
        const double x = begin + i * step;
        const double density = 2.0 * x * std::exp(log_bessel_i0(2.0 * x * root) - x * x - energy);
        const double some_other_higher =
            -std::expm1((tones - 1) * std::log1p(-std::min(std::exp(-x * x), 1.0 - 1e-15)));
        sum += (i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * density * some_other_higher;
    }
    return sum * step / 3.0;
}

double energy_for_symbol_error(double error, int tones) {
    double low = 0.0, high = 200.0;
    while (high - low > 1e-9) {
        const double middle = 0.5 * (low + high);
        (symbol_error(middle, tones) > error ? low : high) = middle;
    }
    return low;
}

}  // namespace aeolis::telemetry
