// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris.hpp"
#include "common/result.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis {

/// A segment of an attitude kernel of type 3: pointing at discrete times, joined within intervals. [naif-ck]
///
/// Times are ticks of the spacecraft's clock, 1/65536 s here, which a clock kernel ties to ephemeris time.
struct CkSegment {
    struct Pointing {
        double sclk_ticks = 0.0;
        std::array<double, 4> q_BA{1.0, 0.0, 0.0, 0.0};   ///< w, x, y, z: turns components in A into components in B
        std::optional<std::array<double, 3>> w_AB_A_rps;  ///< of B in A, components in A [rad/s]
    };
    std::string name;
    std::int32_t structure = 0, frame = 1, type = 3;
    double start_ticks = 0.0, stop_ticks = 0.0;
    std::vector<Pointing> pointings;         ///< ticks ascend; empty of other types, which are not read
    std::vector<double> intervals_at_ticks;  ///< beginnings of the intervals within which pointings are joined
};

inline constexpr double ck_ticks_per_s = 65536.0;

Result<std::vector<CkSegment>> read_ck(std::span<const std::uint8_t> file);
/// Fails when a segment is empty, or only some of its pointings have rates.
Result<std::vector<std::uint8_t>> write_ck(const std::vector<CkSegment>& segments, std::string_view program);

/// A text kernel that ties that clock to ephemeris time: SPICE reads no attitude without one. [naif-sclk]
/// @param clock  number of the clock, "-76" of the structure -76000
/// @param at, seconds  an instant in ephemeris time and on the clock; @param rate  seconds of TDB a second of the clock
std::string clock_kernel(std::int32_t clock, EphemerisTime at, double seconds, double rate);

}  // namespace aeolis
