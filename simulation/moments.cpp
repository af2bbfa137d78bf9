// SPDX-License-Identifier: Apache-2.0
#include "simulation/moments.hpp"

#include "simulation/vectors.hpp"

namespace aeolis::simulation {
namespace {

constexpr double slowest_reversal_mps = 1100.0;
constexpr double felt_mps2 = 0.2 * standard_gravity_mps2;
constexpr double certain_bank_rad = 10.0 * degree_rad;
constexpr double certain_fall = 0.7;
constexpr double least_peak_mps2 = 20.0;  // our assumption: no entry is gentler

}  // namespace

TruthEvent moment(const char* name, const TruthState& truth) {
    return {name, truth.sclk, truth.e_s, truth.altitude_m, truth.speed_mps, truth.p_MoB_M_m};
}

std::optional<TruthEvent> BankReversals::observe(const TruthState& truth, double bank_rad) {
    felt_air_ = felt_air_ || truth.sensed_mps2 >= felt_mps2;
    if (!felt_air_) return {};
    const int side = bank_rad >= 0.0 ? 1 : -1;
    if (side_ == 0) side_ = side;
    if (side == side_) {
        crossing_.reset();
        return {};
    }
    if (!crossing_) {
        if (truth.speed_mps < slowest_reversal_mps) return {};
        crossing_ = moment("", truth);
    }
    const double beyond_rad = std::min(std::abs(bank_rad), std::numbers::pi - std::abs(bank_rad));
    if (beyond_rad < certain_bank_rad) return {};
    side_ = side;
    TruthEvent reversal = *crossing_;
    crossing_.reset();
    reversal.name = "bank_reversal_" + std::to_string(++count_);
    return reversal;
}

std::optional<TruthEvent> PeakDeceleration::observe(const TruthState& truth) {
    if (told_ || truth.e_s < 0.0) return {};
    if (truth.sensed_mps2 > peak_mps2_) {
        peak_mps2_ = truth.sensed_mps2;
        peak_ = moment("peak_deceleration", truth);
    }
    if (peak_mps2_ < least_peak_mps2 || truth.sensed_mps2 > certain_fall * peak_mps2_) return {};
    told_ = true;
    return peak_;
}

}  // namespace aeolis::simulation
