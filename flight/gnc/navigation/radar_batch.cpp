#include "flight/gnc/navigation/radar_batch.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

namespace {

constexpr std::uint16_t beams_min = 12;     // two rounds of six; ours
constexpr double cosine_min = 0.2588;       // 75°: below that range says little of altitude; ours
constexpr double quarters_per_second = 4.0; // bins

std::int64_t quarter_of(Sclk time) {
    return static_cast<std::int64_t>(std::floor(time.seconds * quarters_per_second));
}

} // namespace

void RadarBatch::on(Sclk now, std::span<const RadarBeam> beams, const Quaternion& q_MB, const Vector3& up_M) {
    const std::int64_t quarter = quarter_of(now);
    Bin& bin = bins_[static_cast<std::size_t>(quarter) % bins_.size()];
    for (const RadarBeam& beam : beams) {
        if (!beam.valid) continue;
        const Vector3 d_M = q_MB * to_vector(beam.direction_B);
        const double down = -d_M.dot(up_M);
        if (!(down >= cosine_min)) continue;
        if (bin.quarter != quarter) {
            bin = Bin{};
            bin.quarter = quarter;
            bin.first = now;
        }
        bin.last = now;
        bin.time_sum_s += now.seconds - static_cast<double>(quarter) / quarters_per_second;
        bin.altitude_sum_m += beam.range_m * down;
        bin.normal += d_M * d_M.transpose();
        bin.right -= beam.range_rate_mps * d_M;
        ++bin.beams;
    }
}

std::optional<RadarSolution> RadarBatch::solve(Sclk now) const {
    const std::int64_t newest = quarter_of(now);
    const auto oldest = newest - static_cast<std::int64_t>(bins_.size());
    RadarSolution solution;
    Matrix3 normal = Matrix3::Zero();
    Vector3 right = Vector3::Zero();
    double time_sum_s = 0.0;
    Sclk first = now, last{0.0};
    for (const Bin& bin : bins_) {
        if (bin.beams == 0 || bin.quarter <= oldest || bin.quarter > newest) continue;
        normal += bin.normal;
        right += bin.right;
        solution.altitude_m += bin.altitude_sum_m;
        // Times relative to `newest` keep the sum small and so exact enough.
        time_sum_s += bin.time_sum_s + static_cast<double>(bin.quarter - newest) / quarters_per_second * bin.beams;
        solution.beams = static_cast<std::uint16_t>(solution.beams + bin.beams);
        first = std::min(first, bin.first);
        last = std::max(last, bin.last);
    }
    if (solution.beams < beams_min) return std::nullopt;
    const double count = solution.beams;
    // Three directions that span space: the determinant of their mean square is far from nil (0.004 with MSL's beams).
    if (!((normal / count).determinant() > 1.0e-4)) return std::nullopt;
    const Vector3 v_M = normal.inverse() * right;
    solution.v_MB_M_mps = to_array(v_M);
    solution.altitude_m /= count;
    solution.time = {static_cast<double>(newest) / quarters_per_second + time_sum_s / count};
    solution.span_s = last - first;
    return solution;
}

} // namespace aeolis::flight::gnc
