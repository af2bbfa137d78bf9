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
/// A spacecraft's clock (no epoch) needs both kernels, the epochs GPS and TAI the leap seconds, UNIX nothing. None for
/// other epochs, and outside the kernels' range.
std::optional<UtcInstant> scet_of(const PacketTime& time, const TimeKernels& kernels);

/// The instant in day-of-year form, else the seconds as a number. "undefined" when a given clock kernel does not cover
/// the count.
std::string time_text(const PacketTime& time, const TimeKernels& kernels);

}  // namespace aeolis::telemetry
