// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/radar_filter.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

namespace {

constexpr double remembered_hz = 16.0;

}  // namespace

void RadarFilter::remember(Sclk now, double altitude_m, const Vector3& v_MB_M) {
    if (now.ticks() % static_cast<std::int64_t>(1.0 / (remembered_hz * seconds_per_tick)) != 0) return;
    past_[next_] = {now, altitude_m, v_MB_M};
    next_ = (next_ + 1) % static_cast<std::uint32_t>(past_.size());
    count_ = std::min(count_ + 1, static_cast<std::uint32_t>(past_.size()));
}

RadarJudgement RadarFilter::on(const Parameters& parameters, const RadarSolution& solution, Sclk now,
                               const Vector3& up_M, const Belief& belief) {
    const double half_s = 0.5 * solution.span_s;
    double altitude_sum_m = 0.0, time_sum_s = 0.0;
    Vector3 v_sum = Vector3::Zero();
    double samples = 0.0;
    const Past* oldest = nullptr;
    const Past* newest = nullptr;
    for (std::uint32_t i = 0; i < count_; ++i) {
        const double from_middle_s = past_[i].time - solution.time;
        if (std::abs(from_middle_s) > half_s + 2.0 * seconds_per_tick) continue;
        altitude_sum_m += past_[i].altitude_m;
        v_sum += past_[i].v_MB_M;
        time_sum_s += from_middle_s;
        if (oldest == nullptr || past_[i].time < oldest->time) oldest = &past_[i];
        if (newest == nullptr || past_[i].time > newest->time) newest = &past_[i];
        samples += 1.0;
    }
    // Otherwise averages over different times would be compared.
    if (samples < std::max(1.0, parameters.radar_covered_fraction * remembered_hz * solution.span_s)) return {};

    AEOLIS_CHECK(oldest != nullptr && newest != nullptr);
    // The remaining difference between the mean times of the history and of the radar is removed by the mean rates.
    const double late_s = time_sum_s / samples;
    const Vector3 a_mean = (newest->v_MB_M - oldest->v_MB_M) / std::max(newest->time - oldest->time, 0.0625);
    const Vector3 v_mean = v_sum / samples - late_s * a_mean;
    const double altitude_m = altitude_sum_m / samples - late_s * v_mean.dot(up_M);
    const double residual_h_m = solution.altitude_m - altitude_m;
    const Vector3 residual_v = to_vector(solution.v_MB_M_mps) - v_mean;

    const auto altitude_within = [&](double sigmas) {
        return at_most(Quantity::radar_altitude_residual_m, std::abs(residual_h_m),
                       parameters.radar_altitude_gate_m +
                           parameters.radar_altitude_gate_fraction * solution.altitude_m +
                           sigmas * belief.altitude_m());
    };
    const auto velocity_within = [&](double sigmas) {
        return at_most(Quantity::radar_velocity_residual_mps, residual_v.norm(),
                       parameters.radar_velocity_gate_mps + sigmas * belief.velocity_mps());
    };
    const Condition altitude = altitude_within(parameters.radar_gate_sigmas);
    const Condition velocity = velocity_within(parameters.radar_gate_sigmas);
    const Condition enough =
        at_least(Quantity::refused_in_a_row, refused_in_a_row_, std::floor(parameters.radar_refused_max));
    RadarJudgement judgement;
    for (const Condition& condition : {altitude, velocity, enough}) judgement.conditions.push_back(condition);
    if (accepted_ > 0 && !(altitude.holds && velocity.holds) && !enough.holds) {
        ++refused_;
        ++refused_in_a_row_;
        judgement.verdict = RadarJudgement::Verdict::refused;
        return judgement;
    }
    const bool near = altitude_within(0.0).holds && velocity_within(0.0).holds;
    judgement.verdict =
        accepted_ == 0 || (near && !enough.holds) ? RadarJudgement::Verdict::taken : RadarJudgement::Verdict::believed;
    const bool whole = accepted_ == 0 || judgement.verdict == RadarJudgement::Verdict::believed;
    const double gain = whole ? 1.0 : parameters.radar_gain;
    const double altitude_gain = whole ? 1.0 : parameters.radar_altitude_gain;
    refused_in_a_row_ = 0;
    ++accepted_;

    RadarCorrection& correction = judgement.correction;
    correction.gain = gain;
    correction.v_M_mps = gain * residual_v;
    // A velocity error has also become an altitude error since the middle of the span.
    const double since_middle_s = now - solution.time;
    correction.altitude_m = altitude_gain * residual_h_m + correction.v_M_mps.dot(up_M) * since_middle_s;
    for (std::uint32_t i = 0; i < count_; ++i) {
        past_[i].altitude_m += correction.altitude_m + correction.v_M_mps.dot(up_M) * (past_[i].time - now);
        past_[i].v_MB_M += correction.v_M_mps;
    }
    return judgement;
}

}  // namespace aeolis::flight::gnc
