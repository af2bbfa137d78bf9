// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

// Averages the landing radar's beams of the last 5 s into one altitude and one velocity.
// Run by EdlBg. R25
//
//   in each quarter of a second   altitude = mean of −range · (d_M · up)
//                                 velocity = least squares of d_M · v = −range rate
//   then the mean over the quarters
//
// Frame    beams in B, transformed to M by the navigated attitude at the measurement; up is the local vertical
// In       beams as received (six at 20 Hz)        Out   one solution on request, about once a second
// Memory   sums of twenty quarters of a second
// Valid    flat ground below; beams within 75° of the vertical, others are left out
// Source   [facts] Vehicle: six beams at 20 Hz, averages over 5 s [msl-edl-fsw-paper]; the form is our assumption
namespace aeolis::flight::gnc {

/// Average of the radar's beams over 5 s, sent to the filter at 1 Hz. R25
/// The filter averages its own history over the same span, so the delay does no harm.
struct RadarSolution {
    Sclk time;                ///< middle of the measurements averaged
    double span_s = 0.0;      ///< from the first measurement averaged to the last
    double altitude_m = 0.0;  ///< above the ground below
    std::array<double, 3> v_MB_M_mps{};
    std::uint16_t beams = 0;
};

inline constexpr double radar_bins_per_second = 4.0;  ///< a quarter of a second: five measurements of each beam

class RadarBatch {
  public:
    /// Adds the beams of one cycle, with the navigated attitude of that cycle and the local vertical in M.
    void on(const Parameters& parameters, Sclk now, std::span<const RadarBeam> beams, const Quaternion& q_MB,
            const Vector3& up_M);

    /// Averages over the last whole quarters of a second, 4.75 s. None when every quarter is left out.
    /// A quarter with too few measurements, or with all in one plane, is left out.
    std::optional<RadarSolution> solve(const Parameters& parameters, Sclk now) const;

    void clear() { bins_ = {}; }

  private:
    struct Bin {
        std::int64_t quarter = -1;  ///< SCLK in quarters of a second
        Sclk first, last;
        double time_sum_s = 0.0;  ///< of the measurements, relative to the bin's start
        double altitude_sum_m = 0.0;
        Matrix3 normal = Matrix3::Zero();
        Vector3 right = Vector3::Zero();
        std::uint16_t beams = 0;
    };
    std::array<Bin, static_cast<std::size_t>(build_parameters.radar_average_s* radar_bins_per_second)> bins_{};
};

}  // namespace aeolis::flight::gnc
