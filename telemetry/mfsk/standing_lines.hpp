// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// A line that stands still in the samples.
struct StandingLine {
    double frequency_hz = 0.0;
    double energy = 0.0;  ///< of a look (8 s), over the noise's density
};

/// Lines that stand still in the samples within 300 Hz of a frequency: what a receiver brings with it (its DC, spurs),
/// and a carrier whose Doppler does not change.
///
/// In      samples as they were received; what is not a number is left out
/// Out     every 4 s, from a spectrum of 8 s: the lines that were at the same frequency to 0.15 Hz 4 s before, too
/// Memory  8 s at some 1024 samples a second
class StandingLines {
  public:
    static constexpr double reach_hz = 300.0;  ///< to either side; chosen

    StandingLines(double rate_hz, double middle_hz);
    ~StandingLines();
    StandingLines(const StandingLines& other);
    StandingLines(StandingLines&&) noexcept;
    StandingLines& operator=(StandingLines&&) noexcept;

    void push(std::span<const std::complex<float>> samples);

    double middle_hz() const;
    /// Strongest first, of the newest look; empty before the second one.
    const std::vector<StandingLine>& lines() const;
    /// Whether there is more within reach than these lines and noise, as of a carrier that moves.
    bool holds_more() const;
    /// How many spectra were looked at.
    std::int64_t looks() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::telemetry
