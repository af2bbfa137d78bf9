// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// A carrier found by the search, as at the middle of its window.
struct CarrierFound {
    std::int64_t first_sample = 0,
                 last_sample = 0;  ///< the window, in samples since the search began; last is excluded
    double frequency_hz = 0.0;     ///< from the centre of the samples' band
    double rate_hzps = 0.0;
    double carrier_n0_hz = 0.0;  ///< carrier power to noise density, roughly
    double statistic = 0.0;      ///< sum of the segments' powers along the line; in noise each has mean 1
    double threshold = 0.0;      ///< exceeded by noise alone at most once in 1/false_alarm windows
};

/// Finds carriers of unknown frequency and rate.
///
/// Powers of 20 ms Fourier transforms, over the noise beside them, are summed along straight lines of frequency against
/// time.
/// In      complex samples at a fixed rate; the search covers their whole band. A sample of exactly 0 is a gap
/// Out     carriers in a window of 1 s, over ±1200 Hz/s in lines of 50 Hz/s, the strongest first; after four windows
///         without one, also in the window of all 4 s, over ±300 Hz/s in lines of 12.5
/// Memory  the powers of 4 s
/// Faults  the threshold is a union bound: Pfa of a window ≤ false_alarm in noise whose density changes little over 1
///         kHz, and anyhow with time. The noise of a frequency is the greater of the medians to either side, so that
///         the edge of a filter gives no carrier. Zero power gives no carrier
/// Source: [richards-radar] for the non-coherent sum and its distribution; lengths and grid are chosen.
class CarrierSearch {
  public:
    static constexpr double false_alarm = 1e-4;  ///< of a window; chosen

    explicit CarrierSearch(double rate_hz);
    ~CarrierSearch();
    CarrierSearch(const CarrierSearch&);
    CarrierSearch(CarrierSearch&&) noexcept;
    CarrierSearch& operator=(CarrierSearch&&) noexcept;

    static constexpr std::size_t found_max = 3;  ///< in a window; chosen

    /// Takes samples, and appends the carriers found to `out`. Without `looks` it only keeps their powers.
    void push(std::span<const std::complex<float>> samples, std::vector<CarrierFound>& out, bool looks = true);

    /// Samples of the longest window: a caller that tracks from its start must keep that many.
    std::int64_t longest_window_samples() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Probability that the sum of `count` unit exponentials exceeds `x`: e^−x Σ xⁱ/i!, i < count.
double exceeded_by_noise(int count, double x);

}  // namespace aeolis::telemetry
