// SPDX-License-Identifier: Apache-2.0
#include "common/bessel.hpp"

#include <cmath>
#include <numbers>

namespace aeolis {

double log_bessel_i0(double x) {
    if (x < 20.0) {
        const double quarter = 0.25 * x * x;
        double term = 1.0, sum = 1.0;
        for (int k = 1; k < 60 && term > 1e-12 * sum; ++k) {
            term *= quarter / (static_cast<double>(k) * k);
            sum += term;
        }
        return std::log(sum);
    }
    const double y = 1.0 / (8.0 * x);
    return x - 0.5 * std::log(2.0 * std::numbers::pi * x) + std::log1p(y * (1.0 + y * (4.5 + y * 37.5)));
}

}  // namespace aeolis
