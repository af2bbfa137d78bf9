// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/mfsk/spectrum.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::telemetry {

inline constexpr std::size_t thinned_bins = 512;  ///< chosen: 0.5 MB for 1000 s

/// The spectrum of a second of samples, by frequency from the lowest up; bin n has the middle first_hz + n · bin_hz.
struct ThinnedRow {
    double time_s = 0.0;  ///< of the second's middle
    double first_hz = 0.0, bin_hz = 0.0;
    /// Mean power of each bin over the row's median: octet n stands for n/2 − 30 dB, as in ToneSpectrum.
    std::vector<std::uint8_t> levels;
};

/// Spectra of samples, one row a second.
///
/// In       samples in order, complex baseband; exactly 0 is a gap        Out   rows; none of a second that is all gap
/// Memory   a transform's samples                       Rate    1 ms of processor time a second of 16 kHz
/// A value.
class ThinnedSpectrum {
  public:
    ThinnedSpectrum(double rate_hz, double start_s);

    void push(std::span<const std::complex<float>> samples);
    /// Rows since the last call.
    std::vector<ThinnedRow> take();

  private:
    void transform();
    void end_row();

    double rate_hz_, start_s_;
    Spectrum spectrum_;
    std::size_t transforms_a_row_;
    std::vector<std::complex<float>> waiting_;
    std::array<double, thinned_bins> powers_{};
    std::size_t transforms_ = 0, without_gap_ = 0;  ///< of this row
    std::int64_t rows_ = 0;
    std::vector<ThinnedRow> done_;
};

}  // namespace aeolis::telemetry
