// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/radar_batch.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

namespace {

std::int64_t quarter_of(Sclk time) {
    return static_cast<std::int64_t>(std::floor(time.seconds * radar_bins_per_second));
}

}  // namespace

void RadarBatch::on(const Parameters& parameters, Sclk now, std::span<const RadarBeam> beams, const Quaternion& q_MB,
                    const Vector3& up_M) {
    const std::int64_t quarter = quarter_of(now);
    Bin& bin = bins_[static_cast<std::size_t>(quarter) % bins_.size()];
    for (const RadarBeam& beam : beams) {
        if (!beam.valid) continue;
        const Vector3 d_M = q_MB * to_vector(beam.direction_B);
        const double down = -d_M.dot(up_M);
        if (!(down >= parameters.radar_beam_cosine_min)) continue;
        if (bin.quarter != quarter) {
            bin = Bin{};
            bin.quarter = quarter;
            bin.first = now;
        }
        bin.last = now;
        bin.time_sum_s += now.seconds - static_cast<double>(quarter) / radar_bins_per_second;
        bin.altitude_sum_m += beam.range_m * down;
        bin.normal += d_M * d_M.transpose();
        bin.right -= beam.range_rate_mps * d_M;
        ++bin.beams;
    }
}

std::optional<RadarSolution> RadarBatch::solve(const Parameters& parameters, Sclk now) const {
    const std::int64_t newest = quarter_of(now);  // not complete yet
    const auto oldest = newest - static_cast<std::int64_t>(bins_.size()) + 1;
    RadarSolution solution;
    Vector3 v_sum = Vector3::Zero();
    double altitude_sum_m = 0.0, time_sum_s = 0.0, bins = 0.0;
    Sclk first = now, last{0.0};
    for (const Bin& bin : bins_) {
        if (bin.beams < parameters.radar_beams_min || bin.quarter < oldest || bin.quarter >= newest) continue;
        const double count = bin.beams;
        // The directions span space: the determinant of their mean square is far from zero (0.004 with MSL's beams).
        constexpr double determinant_min = 1.0e-4;
        if (!((bin.normal / count).determinant() > determinant_min)) continue;
        // Each quarter is solved separately: a common sum would mix velocities while the vehicle turns and brakes.
        v_sum += bin.normal.inverse() * bin.right;
        altitude_sum_m += bin.altitude_sum_m / count;
        // Times relative to `newest` keep the sum small and therefore precise.
        time_sum_s += bin.time_sum_s / count + static_cast<double>(bin.quarter - newest) / radar_bins_per_second;
        solution.beams = static_cast<std::uint16_t>(solution.beams + bin.beams);
        first = std::min(first, bin.first);
        last = std::max(last, bin.last);
        bins += 1.0;
    }
    if (bins == 0.0) return std::nullopt;
    solution.v_MB_M_mps = to_array(Vector3(v_sum / bins));
    solution.altitude_m = altitude_sum_m / bins;
    solution.time = {static_cast<double>(newest) / radar_bins_per_second + time_sum_s / bins};
    solution.span_s = last - first;
    return solution;
}

}  // namespace aeolis::flight::gnc
