// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/clock_kernel.hpp"
#include "telemetry/container_decoder.hpp"

#include <optional>
#include <string>

namespace aeolis::telemetry {

/// The kernels that convert a packet's time to UTC, as far as given.
struct TimeKernels {
    std::optional<ClockKernel> clock;
    std::optional<LeapSeconds> leaps;
    std::optional<std::size_t> partition;  ///< of the clock; none: the first that holds the count
};

/// The UTC instant of a packet's time, where known.
///
/// Days and seconds of the day (CDS) since a known midnight need nothing: they are of UTC, without leap seconds.
/// A spacecraft's clock (no epoch) needs both kernels, UNIX nothing, other epochs the leap seconds: GPS, TAI, J2000
/// (2000-01-01T12:00:00 TT [naif-time]) and dates, "2000-01-01" or "2000-01-01T12:00:00". XTCE does not say of what
/// scale a date is: taken as UTC, and the seconds since it as elapsed ones, leap seconds included; 1970-01-01 as UNIX
/// and 1958-01-01 as TAI. None for other epochs, and outside the kernels' range.
std::optional<UtcInstant> scet_of(const PacketTime& time, const TimeKernels& kernels);

/// The instant in day-of-year form, else the seconds as a number, with "s after" and the epoch where that is J2000, a
/// date or unknown. "undefined" when a given clock kernel does not cover the count.
std::string time_text(const PacketTime& time, const TimeKernels& kernels);

}  // namespace aeolis::telemetry
