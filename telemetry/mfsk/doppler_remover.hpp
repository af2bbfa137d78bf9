// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"

#include <complex>
#include <cstdint>
#include <span>

namespace aeolis::telemetry {

/// Removes an expected Doppler from the samples of a receiver whose oscillator stayed at one frequency.
///
/// In, out  samples in order, portions of any size; the phase is continuous
/// Rule     the frequency is taken from the table each 1/64 s and is linear between
class DopplerRemover {
  public:
    /// `expected_hz`: frequency in the samples by time. `start_s`: time of the first sample.
    DopplerRemover(TimeTable expected_hz, double rate_hz, double start_s);

    void remove(std::span<std::complex<float>> samples);

  private:
    void begin_step();

    TimeTable expected_hz_;
    double rate_hz_, start_s_;
    int step_samples_, left_ = 0;
    std::int64_t sample_ = 0;
    double cycles_ = 0.0;
    std::complex<double> phasor_, turn_, bend_;
};

}  // namespace aeolis::telemetry
