#pragma once

#include "common/time_table.hpp"
#include "simulation/links/fast_normal.hpp"
#include "simulation/links/tone_waveform.hpp"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// What an X-band signal meets on its way to the samples of a ground station.
struct XBandPath {
    double rate_hz = 16384.0;       ///< of the samples; ours
    double start_s = 0.0;           ///< time of the first sample, in which tones, Doppler and gain are given
    double total_c_n0_dbhz = 22.0;  ///< total power to noise density at gain 0
    TimeTable doppler_hz;           ///< one way, at the carrier; also scales the subcarrier, as motion does
    TimeTable predict_hz;           ///< removed before sampling, imperfect as it may be
    TimeTable gain_db;              ///< antennas, attitude; empty: 0
    std::optional<double> set_s;    ///< nothing but noise from here on: Earth set
};

/// Complex baseband samples of a station that receives tones: phase-continuous Doppler with all its rates, amplitude
/// against time, white noise of power 1 a sample (N0 = 1/rate).
///
/// In      tones in the order of their starts, each a symbol long and none before the last has ended; between them carrier
/// Out     samples, as many as asked for at a time; the same whatever the portions
/// Memory  one modulated tone's table; nothing grows
class XBandChannel {
  public:
    XBandChannel(const MfskWaveform& waveform, XBandPath path, std::vector<SentTone> tones, std::uint64_t seed,
                 std::uint64_t case_number);

    void next(std::span<std::complex<float>> samples);

  private:
    /// Over a step Doppler is linear and gain constant.
    void begin_step();
    bool sending(double time_s);

    MfskWaveform waveform_;
    XBandPath path_;
    std::vector<SentTone> tones_;
    FastNormal noise_;
    std::size_t tone_ = 0; ///< the one that is or will be sent
    std::optional<ModulatedTone> modulated_;
    std::optional<std::size_t> modulated_for_;

    std::int64_t sample_ = 0;
    int step_left_ = 0, step_samples_;
    double step_end_residual_hz_, step_end_doppler_hz_;
    std::complex<double> carrier_{1.0, 0.0}, turn_, turn_of_turn_;
    double lead_s_ = 0.0, lead_rate_ = 0.0; ///< the subcarrier's time runs ahead by this: ∫ Doppler / carrier
    float amplitude_ = 0.0F;
};

} // namespace aeolis::simulation
