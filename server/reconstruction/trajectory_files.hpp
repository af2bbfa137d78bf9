// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris.hpp"
#include "common/result.hpp"
#include "flight/gnc/navigation/strapdown.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::reconstruction {

/// A point of a flown path, in frame M (docs/frames_and_units.md).
struct TimedState {
    Sclk at;
    flight::gnc::NavigatedState state;
};

/// The formats in which a path leaves, by the ending of a file's name.
enum class TrajectoryFormat : std::uint8_t {
    oem,  ///< .oem: CCSDS orbit ephemeris, J2000 axes about Mars
    aem,  ///< .aem: CCSDS attitude ephemeris, from J2000 to the vehicle
    spk,  ///< .bsp: SPICE trajectory of type 13
    ck,   ///< .bc: SPICE attitude of type 3, without rates; its clock is in the kernel of the next
    sclk  ///< .tsc: SPICE clock kernel
};
std::optional<TrajectoryFormat> trajectory_format_of(std::string_view file_name);

/// The octets of a file of that format. Fails with fewer than four states.
/// @param clock     ties SCLK to UTC; the table of leap seconds is the program's
/// @param created   when the file is made
Result<std::string> trajectory_file(TrajectoryFormat format, std::span<const TimedState> path,
                                    const ClockCorrelation& clock, Scet created);

/// A trajectory that someone else made, relative to rotating Mars.
class ForeignTrajectory {
  public:
    struct State {
        std::array<double, 3> p_MoB_M_m{}, v_MB_M_mps{};
    };
    /// Reads an OEM or an SPK, told apart by their beginning. Fails when it is neither, or when none of its segments is
    /// of a spacecraft about Mars in J2000 (EME2000, ICRF) or Mars's own frame; the message says which there are.
    static Result<ForeignTrajectory> read(std::span<const std::uint8_t> octets);

    /// None where no segment covers the instant.
    std::optional<State> at(EphemerisTime time) const;
    EphemerisTime start() const;
    EphemerisTime stop() const;
    /// When it first comes down to that radius; none: it does not.
    std::optional<EphemerisTime> reaches(double radius_m) const;

  private:
    struct Segment {
        Ephemeris ephemeris;
        bool mars_fixed = false;
    };
    std::vector<Segment> segments_;
};

/// How far a flown state is from another, along axes of the other: up, along its ground track, to its right.
struct Residual {
    double up_m = 0.0, along_m = 0.0, right_m = 0.0, speed_mps = 0.0;
};
Residual residual_of(const flight::gnc::NavigatedState& flown, const ForeignTrajectory::State& other);

}  // namespace aeolis::reconstruction
