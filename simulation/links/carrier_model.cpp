// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/carrier_model.hpp"

#include "simulation/links/x_band_link.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace aeolis::simulation {
namespace {

constexpr std::array<int, 3> windows{39, 25, 7};       // cycles; the first is the usual one
constexpr int estimate_cycles = 8;                     // an eighth of a second
constexpr double least_coherence = 0.7;                // chosen: a rate that is right keeps more of its power
constexpr double least_energy = 8.0;                   // 9 dB; chosen, as the tracker's least
constexpr double quick_dbhz = 20.5, slow_dbhz = 15.8;  // of the carrier: found in 1 s, in 4 s (docs/tones.md)
constexpr int quick_cycles = 64, slow_cycles = 256;    // 1 s, 4 s
constexpr int missed_most = 12;                        // 1.5 s
constexpr double turn_rad = 2.0 * std::numbers::pi;

}  // namespace

CarrierModel::CarrierModel(double total_c_n0_dbhz, TimeTable predict_hz, std::uint64_t seed, std::uint64_t case_number)
    : total_c_n0_dbhz_(total_c_n0_dbhz), predict_hz_(std::move(predict_hz)),
      random_(seed, case_number, Stream::carrier) {}

bool CarrierModel::can_acquire(double total_c_n0_dbhz) {
    return total_c_n0_dbhz + XBandLink::carrier_power_db() >= slow_dbhz;
}

/// Fits a parabola to the phases of the `length` cycles in the middle of the memory.
CarrierModel::Fit CarrierModel::fit(int length) const {
    const int half = length / 2, middle = longest / 2;
    // Orthogonal polynomials over −half … half: 1, u, u² − mean.
    double uu = 0.0, u4 = 0.0;
    for (int u = -half; u <= half; ++u) {
        const double squared = static_cast<double>(u) * u;
        uu += squared;
        u4 += squared * squared;
    }
    const double mean = uu / length, ww = u4 - uu * mean;
    const double reference = cycle(middle).phase_cycles;
    double slope = 0.0, bend = 0.0, level = 0.0, noise_slope = 0.0, noise_bend = 0.0, power = 0.0, in_phase = 0.0;
    for (int u = -half; u <= half; ++u) {
        const Cycle& at = cycle(middle - u);
        const double phase = at.phase_cycles - reference, w = static_cast<double>(u) * u - mean;
        const double noise = at.amplitude > 0.0 ? at.noise_sin / at.amplitude / turn_rad : 0.0;
        level += phase / length;
        slope += u * phase / uu;
        bend += w * phase / ww;
        noise_slope += u * noise / uu;
        noise_bend += w * noise / ww;
        power += at.amplitude * at.amplitude / length;
        in_phase += at.noise_cos / length;
    }
    std::complex<double> sum;
    for (int u = -half; u <= half; ++u) {
        const Cycle& at = cycle(middle - u);
        const double w = static_cast<double>(u) * u - mean;
        sum += std::polar(at.amplitude, turn_rad * (at.phase_cycles - reference - level - slope * u - bend * w));
    }
    Fit found{};
    found.coherence = power > 0.0 ? std::norm(sum / static_cast<double>(length)) / power : 0.0;
    found.frequency_hz = (slope + noise_slope) / seconds_per_tick;
    found.rate_hzps = 2.0 * (bend + noise_bend) / (seconds_per_tick * seconds_per_tick);
    found.amplitude = std::abs(sum) / length + in_phase;
    // The noise across of a cycle has variance 1 / (2 · 1/64 s) beside the amplitude √(C/N0).
    const double phase_deviation_cycles =
        std::sqrt(0.5 / seconds_per_tick) / std::max(found.amplitude, 1.0e-3) / turn_rad;
    found.sigma_hz = phase_deviation_cycles / std::sqrt(uu) / seconds_per_tick;
    return found;
}

std::optional<telemetry::ReceivedCarrier::Estimate> CarrierModel::estimate(bool& short_window) const {
    for (const int length : windows) {
        const Fit found = fit(length);
        const double energy = found.amplitude * found.amplitude * length * seconds_per_tick;
        if (found.coherence < least_coherence || found.amplitude <= 0.0 || energy < least_energy) continue;
        short_window = length != longest;
        const double noise_power = 0.5 / (length * seconds_per_tick);  // of the amplitude's estimate
        const double carrier_hz = std::max(found.amplitude * found.amplitude - noise_power, 1.0);
        return telemetry::ReceivedCarrier::Estimate{found.frequency_hz, found.sigma_hz, found.rate_hzps,
                                                    10.0 * std::log10(carrier_hz) - XBandLink::carrier_power_db()};
    }
    return std::nullopt;
}

std::optional<telemetry::ReceivedCarrier> CarrierModel::hear(const XBandField& field) {
    const double carrier_dbhz =
        total_c_n0_dbhz_ + field.gain_db + (field.tone ? XBandLink::carrier_power_db() : 0.0);  // alone it has all
    const bool audible = field.up && can_acquire(total_c_n0_dbhz_ + field.gain_db);
    present_ = audible ? present_ + 1 : 0;

    Cycle& newest = cycles_[static_cast<std::size_t>(next_)];
    newest.ert = field.ert;
    newest.e_s = field.e_s;
    newest.phase_cycles = phase_cycles_;
    newest.amplitude = field.up ? std::sqrt(std::pow(10.0, carrier_dbhz / 10.0)) : 0.0;
    const double noise = std::sqrt(0.5 / seconds_per_tick);
    newest.noise_cos = noise * random_.normal();
    newest.noise_sin = noise * random_.normal();
    phase_cycles_ += (field.doppler_hz - predict_hz_.at(field.e_s)) * seconds_per_tick;
    next_ = (next_ + 1) % longest;
    filled_ = std::min(filled_ + 1, longest);
    if (++heard_ % estimate_cycles != 0 || filled_ < longest) return std::nullopt;

    if (!follows_ && present_ >= (carrier_dbhz >= quick_dbhz ? quick_cycles : slow_cycles)) {
        follows_ = true;
        missed_ = 0;
    }
    if (!follows_) return std::nullopt;
    const Cycle& middle = cycle(longest / 2);
    telemetry::ReceivedCarrier told{field.ert, middle.ert, predict_hz_.at(middle.e_s), CarrierLock::coasting, {}};
    bool short_window = false;
    told.estimate = estimate(short_window);
    missed_ = told.estimate ? 0 : missed_ + 1;
    if (told.estimate) told.lock = short_window ? CarrierLock::fluctuating : CarrierLock::locked;
    if (missed_ >= missed_most) {
        follows_ = false;
        present_ = 0;
        told.lock = CarrierLock::searching;
    }
    return told;
}

}  // namespace aeolis::simulation
