// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "simulation/links/x_band_front_end.hpp"
#include "simulation/random.hpp"
#include "telemetry/port.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace aeolis::simulation {

/// A statistical model of a receiver's estimates of the X-band carrier: no samples, but a phase with noise each 1/64 s.
///
/// Eight times a second a parabola is fitted to the phases of 39, 25 or 7 cycles (0.61, 0.39, 0.11 s: the windows of
/// telemetry/mfsk/carrier_tracker), the longest over which the carrier keeps coherent. Its slope is the frequency. So
/// neighbouring estimates have noise in common, and a swerve smears or is not found, as it is with samples. The carrier
/// is found with an energy of 9 dB in the window. The carrier is acquired after 1 s at 20.5 dB-Hz, after 4 s at 15.8
/// (docs/tones.md);
/// it is lost after 1.5 s without being found. Left out: false carriers, and cycle slips.
/// In       X-band fields, one a cycle without a gap         Out   estimates, half the longest window late
/// A value; copies continue alike.
class CarrierModel {
  public:
    /// `predict_hz`: by seconds from the scenario's entry.
    CarrierModel(double total_c_n0_dbhz, TimeTable predict_hz, std::uint64_t seed, std::uint64_t case_number);

    std::optional<telemetry::ReceivedCarrier> hear(const XBandField& field);
    bool follows() const { return follows_; }  ///< a carrier, found or not found for a moment
    /// Whether a search finds the carrier at this total power to noise density, in 4 s.
    static bool can_acquire(double total_c_n0_dbhz);

  private:
    static constexpr int longest = 39;  ///< cycles
    struct Cycle {
        Ert ert;
        double e_s = 0.0;
        double phase_cycles = 0.0;                ///< of the carrier less its predict, without noise
        double amplitude = 0.0;                   ///< carrier power to noise density is its square; [√Hz]
        double noise_cos = 0.0, noise_sin = 0.0;  ///< in phase with the carrier and across
    };
    struct Fit {
        double frequency_hz, rate_hzps, coherence, amplitude;
        double sigma_hz;
    };
    const Cycle& cycle(int back) const {
        return cycles_[static_cast<std::size_t>((next_ + 2 * longest - 1 - back) % longest)];
    }
    Fit fit(int length) const;
    std::optional<telemetry::ReceivedCarrier::Estimate> estimate(bool& short_window) const;

    double total_c_n0_dbhz_;
    TimeTable predict_hz_;
    Random random_;
    std::array<Cycle, longest> cycles_{};
    int next_ = 0, filled_ = 0;
    std::int64_t heard_ = 0;  ///< cycles, of all
    double phase_cycles_ = 0.0;
    int present_ = 0;  ///< cycles in a row with a carrier that can be acquired
    int missed_ = 0;   ///< estimates in a row without it
    bool follows_ = false;
};

}  // namespace aeolis::simulation
