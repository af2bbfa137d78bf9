// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// The smallest length ≥ `least` and ≥ 8 without prime factors above 5, for which the Fourier transform is fast.
int smooth_length(int least);

/// Peak of a parabola through three equidistant values, in steps from the middle one: −0.5 … 0.5; 0 without a peak.
double peak_offset(double before, double at, double after);

/// Powers of a short stretch of samples by frequency, under a Hann window.
class Spectrum {
  public:
    explicit Spectrum(int samples);
    ~Spectrum();
    Spectrum(const Spectrum&);
    Spectrum(Spectrum&&) noexcept;
    Spectrum& operator=(Spectrum&&) noexcept;

    /// For each frequency, the mean power per sample of white noise that would have its level. The order is: frequency
    /// 0, upwards, then the negative ones. A sample of exactly 0 is a gap.
    const std::vector<float>& powers(std::span<const std::complex<float>> samples);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::telemetry
