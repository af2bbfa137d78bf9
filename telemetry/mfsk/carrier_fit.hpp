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
    double energy = 0.0;  ///< of the window's coherent sum over the noise's; in noise alone exponential with mean 1
};

/// The range of a fit around the prediction.
struct FitSpan {
    double frequency_hz = 0.0;  ///< to either side
    int rate_lines = 0;         ///< to either side, of CarrierFit::rate_step_hzps each
};

/// Maximum-likelihood fit of a carrier's phase line in white noise.
///
/// It takes the highest peak over frequency and rate, by Fourier transforms of the window dechirped at each rate,
/// refined by parabolas. Source: [abatzoglou-1986] for maximum likelihood of a chirp.
class CarrierFit {
  public:
    static constexpr int rate_lines_max = 20;  ///< to either side; chosen

    /// Fits windows of `length` samples at intervals of `step_s`.
    CarrierFit(int length, double step_s);
    ~CarrierFit();
    CarrierFit(const CarrierFit&);
    CarrierFit(CarrierFit&&) noexcept;
    CarrierFit& operator=(CarrierFit&&) noexcept;

    /// Fits one window. `noise`: noise power a sample, above 0.
    CarrierLine fit(std::span<const std::complex<float>> samples, double noise, const FitSpan& span);

    double rate_step_hzps() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::telemetry
