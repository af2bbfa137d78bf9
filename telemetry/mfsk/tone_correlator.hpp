// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"
#include "telemetry/mfsk/carrier_tracker.hpp"

#include <array>
#include <complex>
#include <memory>
#include <span>

namespace aeolis::telemetry {

using ToneSums = std::array<std::complex<float>, MfskWaveform::tones>;

/// Correlates a hop of quadrature with the first harmonic of every tone: c_k = Σ y exp(−j 2π f_k t).
///
/// Noise of deviation 1 a sample gives E|c|² = decimated samples of a hop; a tone of C/N0 ρ adds that times ρ · hop_s.
class ToneCorrelator {
  public:
    ToneCorrelator(const MfskWaveform& waveform, double sample_rate_hz, int samples);
    ~ToneCorrelator();
    ToneCorrelator(const ToneCorrelator&);
    ToneCorrelator(ToneCorrelator&&) noexcept;

    /// Correlates one hop. `begin_s`: the subcarriers' time at its start; sums of consecutive hops may then be added.
    void correlate(std::span<const float> quadrature, double begin_s, ToneSums& sums) const;
    /// The same for the component in phase with the carrier as well.
    void correlate(std::span<const float> quadrature, std::span<const float> in_phase, double begin_s, ToneSums& sums,
                   ToneSums& in_phase_sums) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::telemetry
