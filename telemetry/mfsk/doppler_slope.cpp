// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/doppler_slope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::telemetry {
namespace {

constexpr double change_least_hz = 500.0;  // chosen
constexpr double share_left = 0.1;         // of the Doppler's variance, off the line; chosen

}  // namespace

std::optional<double> doppler_slope(std::span<const CarrierReport> carrier, const TimeTable& doppler_hz) {
    double count = 0.0, d = 0.0, f = 0.0, dd = 0.0, df = 0.0, ff = 0.0;
    double least_hz = std::numeric_limits<double>::infinity(), most_hz = -least_hz;
    const double first_hz = carrier.empty() ? 0.0 : doppler_hz.at(carrier.front().time_s);
    for (const CarrierReport& each : carrier) {
        if (each.lock > CarrierLock::fluctuating) continue;
        const double doppler = doppler_hz.at(each.time_s) - first_hz, frequency = each.frequency_hz;
        least_hz = std::min(least_hz, doppler);
        most_hz = std::max(most_hz, doppler);
        count += 1.0;
        d += doppler;
        f += frequency;
        dd += doppler * doppler;
        df += doppler * frequency;
        ff += frequency * frequency;
    }
    if (count < 3.0 || !(most_hz - least_hz > change_least_hz)) return std::nullopt;
    const double var_d = dd / count - d * d / (count * count), cov = df / count - d * f / (count * count);
    const double var_f = ff / count - f * f / (count * count);
    if (!(var_d > 0.0)) return std::nullopt;
    const double slope = cov / var_d;
    if (var_f - slope * cov > share_left * var_d) return std::nullopt;
    return slope;
}

}  // namespace aeolis::telemetry
