// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <memory>
#include <span>

namespace aeolis::telemetry {

/// A carrier's phase over a window, φ(t) = phase + 2π (frequency t + rate t²/2), t from the window's middle.
struct CarrierLine {
    double phase_rad = 0.0, frequency_hz = 0.0, rate_hzps = 0.0;
    double amplitude = 0.0;
    double energy = 0.0;  ///< of the window's coherent sum over the noise's: mean 1, exponential, in noise alone
};

/// How far a fit looks around what was predicted.
struct FitSpan {
    double frequency_hz = 0.0;  ///< to either side
    int rate_lines = 0;         ///< to either side, of CarrierFit::rate_step_hzps each
};

/// The most likely line of a carrier in white noise: the highest peak over frequency and rate, by Fourier transforms of
/// the window dechirped at each rate, refined by parabolas. Source: [abatzoglou-1986] for maximum likelihood of a
/// chirp.
class CarrierFit {
  public:
    static constexpr int rate_lines_max = 20;  ///< to either side; ours

    /// Windows of `length` samples, `step_s` apart.
    CarrierFit(int length, double step_s);
    ~CarrierFit();
    CarrierFit(const CarrierFit&);
    CarrierFit(CarrierFit&&) noexcept;
    CarrierFit& operator=(CarrierFit&&) noexcept;

    /// `noise`: power of the noise a sample, above 0.
    CarrierLine fit(std::span<const std::complex<float>> samples, double noise, const FitSpan& span);

    double rate_step_hzps() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::telemetry
