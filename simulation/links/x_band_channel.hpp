// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "simulation/links/x_band_sampler.hpp"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// Path of an X-band signal to the samples of a ground station.
struct XBandPath {
    double rate_hz = 16384.0;       ///< of the samples; chosen
    double start_s = 0.0;           ///< time of the first sample, on the scale of tones, Doppler and gain
    double total_c_n0_dbhz = 22.0;  ///< total power to noise density at gain 0
    TimeTable doppler_hz;           ///< one way, at the carrier; also scales the subcarrier, as motion does
    TimeTable predict_hz;           ///< removed before sampling, imperfect as it may be
    TimeTable gain_db;              ///< antennas, attitude; empty: 0
    std::optional<double> set_s;    ///< Earth set: only noise from here on
};

/// Samples (x_band_sampler.hpp) of a path whose tones are known from the start.
///
/// In      tones in the order of their starts, each a symbol long, none overlapping; between them the carrier alone
/// Out     samples, in portions of any size; the portions do not change them
class XBandChannel {
  public:
    XBandChannel(const MfskWaveform& waveform, XBandPath path, std::vector<SentTone> tones, std::uint64_t seed,
                 std::uint64_t case_number);

    void next(std::span<std::complex<float>> samples);

  private:
    /// Begins a step, over which Doppler is linear and gain constant.
    void begin_step();
    double time_s() const {
        return path_.start_s + static_cast<double>(sample_) / path_.rate_hz;
    }  ///< of the next sample
    /// The number of samples from the next one on with the same tone, or with none.
    int alike() const;

    XBandPath path_;
    std::vector<SentTone> tones_;
    double symbol_s_;
    XBandSampler sampler_;
    std::size_t tone_ = 0;  ///< the tone being sent, or the next

    std::int64_t sample_ = 0;
    int step_left_ = 0, step_samples_;
    double step_end_residual_hz_, step_end_doppler_hz_;
};

}  // namespace aeolis::simulation
