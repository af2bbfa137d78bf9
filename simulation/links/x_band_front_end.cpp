// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_front_end.hpp"

#include <utility>

namespace aeolis::simulation {
namespace {

constexpr int cycle_samples = static_cast<int>(telemetry::x_band_rate_hz * seconds_per_tick);

}  // namespace

XBandFrontEnd::XBandFrontEnd(const MfskWaveform& waveform, double total_c_n0_dbhz, TimeTable predict_hz,
                             std::uint64_t seed, std::uint64_t case_number)
    : total_c_n0_dbhz_(total_c_n0_dbhz), predict_hz_(std::move(predict_hz)),
      sampler_(waveform, telemetry::x_band_rate_hz, seed, case_number) {}

telemetry::XBandSamples XBandFrontEnd::sample(const XBandField& field) {
    // The Doppler goes from that of the last cycle's start to that of this one's; the predict removed is of those
    // times.
    const double from_hz = last_doppler_hz_.value_or(field.doppler_hz);
    XBandSampler::Stretch stretch;
    stretch.samples = cycle_samples;
    stretch.residual_to_hz = field.doppler_hz - predict_hz_.at(field.e_s);
    stretch.residual_from_hz =
        last_doppler_hz_ ? from_hz - predict_hz_.at(field.e_s - seconds_per_tick) : stretch.residual_to_hz;
    stretch.doppler_hz = 0.5 * (from_hz + field.doppler_hz);
    if (field.up) stretch.total_c_n0_dbhz = total_c_n0_dbhz_ + field.gain_db;
    sampler_.begin(stretch);
    telemetry::XBandSamples taken{field.ert, std::vector<std::complex<float>>(cycle_samples)};
    std::optional<std::uint8_t> tone;
    if (field.tone) tone = static_cast<std::uint8_t>(field.tone->value);
    sampler_.take(taken.samples, tone, field.tone_age_s);
    last_doppler_hz_ = field.doppler_hz;
    return taken;
}

}  // namespace aeolis::simulation
