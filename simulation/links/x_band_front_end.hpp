// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/mfsk_waveform.hpp"
#include "common/time.hpp"
#include "common/time_table.hpp"
#include "simulation/links/x_band_sampler.hpp"
#include "telemetry/port.hpp"

#include <cstdint>
#include <optional>

namespace aeolis::simulation {

/// The X-band signal at Earth over a cycle: carrier and modulation. Input of an antenna's front end.
struct XBandField {
    Ert ert;                     ///< of the cycle's start
    double e_s = 0.0;            ///< departure from the vehicle, from the scenario's entry
    double doppler_hz = 0.0;     ///< one way, at the cycle's start
    bool up = false;             ///< false: Earth has set, or no antenna is selected; only noise
    double gain_db = 0.0;        ///< of the antenna towards Earth, against its best direction
    std::optional<ToneId> tone;  ///< none: the carrier alone
    double tone_age_s = 0.0;     ///< since the symbol began
};

/// An antenna on Earth with its front end: samples of the arriving signal and noise, less ground's predict.
///
/// In       X-band fields, one a cycle without a gap        Out   a cycle's samples, telemetry::x_band_rate_hz
/// A value; copies continue alike.
class XBandFrontEnd {
  public:
    /// `predict_hz`: by seconds from the scenario's entry.
    XBandFrontEnd(const MfskWaveform& waveform, double total_c_n0_dbhz, TimeTable predict_hz, std::uint64_t seed,
                  std::uint64_t case_number);

    telemetry::XBandSamples sample(const XBandField& field);

  private:
    double total_c_n0_dbhz_;
    TimeTable predict_hz_;
    XBandSampler sampler_;
    std::optional<double> last_doppler_hz_;
};

}  // namespace aeolis::simulation
