// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_sampler.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace simulation_x_band_sampler_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

constexpr double rate_hz = 16384.0;
const MfskWaveform mfsk{.carrier_hz = 8.4e9,
                        .first_tone_hz = 300.0,
                        .tone_spacing_hz = 1.0,
                        .symbol_s = 10.0,
                        .modulation_index_rad = 0.5585};

using Samples = std::vector<std::complex<float>>;

Samples second_of(XBandSampler& sampler, const XBandSampler::Stretch& stretch, std::optional<std::uint8_t> tone = {}) {
    Samples samples(static_cast<std::size_t>(stretch.samples));
    sampler.begin(stretch);
    sampler.take(samples, tone, 0.0);
    return samples;
}

XBandSampler::Stretch steady(std::optional<double> total_c_n0_dbhz, double residual_hz = 0.0) {
    XBandSampler::Stretch stretch;
    stretch.samples = static_cast<int>(rate_hz);
    stretch.residual_from_hz = stretch.residual_to_hz = residual_hz;
    stretch.total_c_n0_dbhz = total_c_n0_dbhz;
    return stretch;
}

/// What is left at `frequency_hz`: the mean of the samples turned back by it.
double amplitude_at(const Samples& samples, double frequency_hz) {
    std::complex<double> sum;
    for (std::size_t i = 0; i < samples.size(); ++i)
        sum += std::complex<double>{samples[i]} *
               std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / rate_hz);
    return std::abs(sum) / static_cast<double>(samples.size());
}

}  // namespace

TEST_CASE("with nothing to hear the samples are noise of power 1", "[tones]") {
    XBandSampler sampler{mfsk, rate_hz, 1, 0};
    double power = 0.0;
    for (const auto& sample : second_of(sampler, steady({}))) power += std::norm(sample) / rate_hz;
    CHECK(power == Approx(1.0).margin(0.04));  // 5 deviations
}

TEST_CASE("the carrier has the power and the frequency that are asked for, and a tone takes its part of it",
          "[tones]") {
    const double amplitude = std::sqrt(1.0e4 / rate_hz);  // 40 dB-Hz
    XBandSampler sampler{mfsk, rate_hz, 1, 0};
    CHECK(amplitude_at(second_of(sampler, steady(40.0, 100.0)), 100.0) == Approx(amplitude).margin(0.03));
    XBandSampler toned{mfsk, rate_hz, 1, 0};
    const Samples samples = second_of(toned, steady(40.0), 7);
    CHECK(amplitude_at(samples, 0.0) == Approx(amplitude * std::cos(mfsk.modulation_index_rad)).margin(0.03));
    const double sideband = amplitude * std::sin(mfsk.modulation_index_rad) * 2.0 / std::numbers::pi;
    CHECK(amplitude_at(samples, 307.0) == Approx(sideband).margin(0.03));
    CHECK(amplitude_at(samples, -307.0) == Approx(sideband).margin(0.03));
    CHECK(amplitude_at(samples, 320.0) < 0.03);
}

TEST_CASE("the phase goes on from one stretch to the next", "[tones]") {
    XBandSampler sampler{mfsk, rate_hz, 1, 0};
    Samples both = second_of(sampler, steady(40.0, 250.0));
    const Samples second = second_of(sampler, steady(40.0, 250.0));
    both.insert(both.end(), second.begin(), second.end());
    CHECK(amplitude_at(both, 250.0) == Approx(std::sqrt(1.0e4 / rate_hz)).margin(0.02));
}

}  // namespace simulation_x_band_sampler_test
