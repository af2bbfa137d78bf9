// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/clock_kernel.hpp"
#include "telemetry/container_decoder.hpp"

#include <optional>
#include <string>

namespace aeolis::telemetry {

/// What turns a packet's own time into UTC, as far as it is given.
struct TimeKernels {
    std::optional<ClockKernel> clock;
    std::optional<LeapSeconds> leaps;
    std::optional<std::size_t> partition;  ///< of the clock; none: the first that holds the count
};

/// The instant in UTC, where that is known: of a spacecraft's clock (no epoch) by both kernels, of the epochs GPS and
/// TAI by the leap seconds, of UNIX always. None for other epochs, and outside what the kernels cover.
std::optional<UtcInstant> scet_of(const PacketTime& time, const TimeKernels& kernels);

/// That instant in day-of-year form, else the seconds as a number; "undefined" where a clock kernel is given and does
/// not cover the count.
std::string time_text(const PacketTime& time, const TimeKernels& kernels);

}  // namespace aeolis::telemetry
