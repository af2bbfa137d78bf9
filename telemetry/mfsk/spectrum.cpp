// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/spectrum.hpp"

#include <algorithm>

namespace aeolis::telemetry {

int smooth_length(int least) {
    for (int n = std::max(least, 8);; ++n) {
        int rest = n;
        for (const int factor : {2, 3, 5})
            while (rest % factor == 0) rest /= factor;
        if (rest == 1) return n;
    }
}

double peak_offset(double before, double at, double after) {
    const double bend = before - 2.0 * at + after;
    return bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace aeolis::telemetry
