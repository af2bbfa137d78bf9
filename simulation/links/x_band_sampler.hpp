// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/links/fast_normal.hpp"
#include "simulation/links/tone_waveform.hpp"

#include <complex>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::simulation {

/// The front end of a ground station: complex baseband samples of carrier and tone, phase-continuous, with white noise.
///
/// Noise has power 1 a sample (N0 = 1/rate).
/// In      stretches, in each of which Doppler is linear and gain constant        Out   their samples, in portions of
///         any size
/// Memory  the table of one modulated tone, of constant size
class XBandSampler {
  public:
    XBandSampler(const MfskWaveform& waveform, double rate_hz, std::uint64_t seed, std::uint64_t case_number);

    struct Stretch {
        int samples = 0;
        double residual_from_hz = 0.0, residual_to_hz = 0.0;  ///< carrier less predict, at both ends
        double doppler_hz = 0.0;                              ///< mean; motion scales the subcarrier with it
        std::optional<double> total_c_n0_dbhz;                ///< none: only noise
    };
    void begin(const Stretch& stretch);

    /// Fills samples of the stretch with a tone that began `tone_age_s` before the first of them, or with the carrier
    /// alone.
    void take(std::span<std::complex<float>> samples, std::optional<std::uint8_t> tone, double tone_age_s);

  private:
    MfskWaveform waveform_;
    double rate_hz_;
    FastNormal noise_;
    std::optional<std::uint8_t> modulated_for_;
    std::optional<ModulatedTone> modulated_;
    std::complex<double> carrier_{1.0, 0.0}, turn_, turn_of_turn_;
    double lead_s_ = 0.0, lead_rate_ = 0.0;  ///< lead of the subcarrier's time: ∫ Doppler / carrier
    float amplitude_ = 0.0F;
};

}  // namespace aeolis::simulation
