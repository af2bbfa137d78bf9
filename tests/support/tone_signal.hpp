// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/links/x_band_channel.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"
#include "tests/support/catch.hpp"

#include <complex>
#include <span>
#include <utility>
#include <vector>

// Samples of tones for tests, with the numbers of the shipped dictionary.
namespace aeolis::tests {

inline constexpr MfskWaveform mfsk{8.4e9, 300.0, 1.0, 10.0, 32.0 * std::numbers::pi / 180.0};

inline TimeTable table(std::vector<double> time_s, std::vector<double> value) {
    auto made = TimeTable::make(std::move(time_s), std::move(value));
    REQUIRE(made);
    return *made;
}

inline std::vector<std::complex<float>> samples_of(const simulation::XBandPath& path,
                                                   const std::vector<simulation::SentTone>& tones, double length_s,
                                                   std::uint64_t seed = 1) {
    std::vector<std::complex<float>> samples(static_cast<std::size_t>(length_s * path.rate_hz));
    simulation::XBandChannel{mfsk, path, tones, seed, 0}.next(samples);
    return samples;
}

inline std::vector<telemetry::ToneReception>
received(telemetry::ToneReceiver& receiver, std::span<const std::complex<float>> samples, std::size_t block = 10000) {
    for (std::size_t at = 0; at < samples.size(); at += block)
        receiver.push(samples.subspan(at, std::min(block, samples.size() - at)));
    receiver.finish();
    return receiver.take();
}

}  // namespace aeolis::tests
