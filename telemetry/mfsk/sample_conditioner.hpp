// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Marks the samples that carry no signal, and removes spectral lines at excluded frequencies.
///
/// In      samples as recorded     Out     as many, in order; a sample without signal is exactly 0, and no other is
/// Gaps    what is not a number; a run of equal samples (zeros, a stuck converter); a pulse 40 dB above the mean power,
///         which noise never is
/// Delay   the run of equal samples at the end waits for what follows it
class SampleConditioner {
  public:
    /// `excluded_hz`: frequencies in the samples; 0 is a DC block.
    SampleConditioner(double rate_hz, std::span<const double> excluded_hz);

    /// Takes out a further line, from the next sample on; it is gone after some 2 s.
    void exclude(double line_hz);
    /// Appends the conditioned samples to `out`. Returns the largest power among them.
    double push(std::span<const std::complex<float>> samples, std::vector<std::complex<float>>& out);
    /// Appends what still waits.
    void finish(std::vector<std::complex<float>>& out);

  private:
    struct Notch {
        std::complex<double> turn, phasor{1.0, 0.0}, line;
    };
    bool is_pulse(const std::complex<float>& sample);
    void end_run(std::vector<std::complex<float>>& out);
    std::complex<float> notched(std::complex<float> sample);

    std::vector<Notch> notches_;
    double rate_hz_, notch_gain_;
    double mean_power_ = 0.0;  ///< recent mean of the samples; 0: none yet
    std::int64_t run_longest_;
    std::complex<float> run_value_;
    std::int64_t run_ = 0;  ///< samples of the run that waits
};

}  // namespace aeolis::telemetry
