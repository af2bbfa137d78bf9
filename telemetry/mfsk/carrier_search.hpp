// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// A carrier as the search found it, at the middle of its window.
struct CarrierFound {
    std::int64_t first_sample = 0,
                 last_sample = 0;  ///< the window, in samples since the search began; last is excluded
    double frequency_hz = 0.0;     ///< from the middle of the samples' band
    double rate_hzps = 0.0;
    double statistic = 0.0;  ///< sum of the segments' powers along the line, each of mean 1 in noise
    double threshold = 0.0;  ///< what noise alone exceeds once in 1/false_alarm windows at most
};

/// Finds a carrier of unknown frequency and rate: powers of 20 ms Fourier transforms are summed along straight lines of
/// frequency against time.
///
/// In      complex samples at a fixed rate; the whole of its band is searched
/// Out     a carrier for a window of 1 s over ±1200 Hz/s in lines of 50 Hz/s; each time four of those found none, also
///         for the window of all 4 s, over ±300 Hz/s in lines of 12.5: its effort grows with the wait
/// Memory  the powers of 4 s
/// Faults  the threshold is a union bound: Pfa of a window ≤ false_alarm in white noise of any power. Without power
///         nothing is found.
/// Source: [richards-radar] for the non-coherent sum and its distribution; lengths and grid ours.
class CarrierSearch {
  public:
    static constexpr double false_alarm = 1e-4;  ///< of a window; ours

    explicit CarrierSearch(double rate_hz);
    ~CarrierSearch();
    CarrierSearch(const CarrierSearch&);
    CarrierSearch(CarrierSearch&&) noexcept;
    CarrierSearch& operator=(CarrierSearch&&) noexcept;

    /// Takes samples until a carrier is found or all are taken.
    std::optional<CarrierFound> push(std::span<const std::complex<float>> samples);

    /// Samples of the longest window: who wants to use a found carrier from its window's start keeps as many.
    std::int64_t longest_window_samples() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Probability that the sum of `count` unit exponentials exceeds `x`: e^−x Σ xⁱ/i!, i < count.
double exceeded_by_noise(int count, double x);

}  // namespace aeolis::telemetry
