// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_time.hpp"

#include <cmath>

namespace aeolis::telemetry {
namespace {

// Epochs in seconds from 2000-01-01T12:00:00 of their own scale, by the calendar. [ccsds-301.0-b-4], [naif-time]
constexpr double unix_epoch_s = -946728000.0;            // 1970-01-01 UTC
constexpr double tai_epoch_s = -1325419200.0;            // 1958-01-01 TAI
constexpr double gps_epoch_tai_s = -630763200.0 + 19.0;  // 1980-01-06 UTC, when TAI was 19 s ahead
constexpr double seconds_max = 1.0e11;

}  // namespace

std::optional<UtcInstant> scet_of(const PacketTime& time, const TimeKernels& kernels) {
    if (!(std::abs(time.seconds) < seconds_max)) return std::nullopt;
    if (time.epoch == "UNIX" || time.epoch == "POSIX")
        return UtcInstant{static_cast<std::int64_t>(std::llround((unix_epoch_s + time.seconds) * 1.0e6)), false};
    if (!kernels.leaps) return std::nullopt;
    if (time.epoch == "GPS") return kernels.leaps->utc_of_tai(gps_epoch_tai_s + time.seconds);
    if (time.epoch == "TAI") return kernels.leaps->utc_of_tai(tai_epoch_s + time.seconds);
    if (!time.epoch.empty() || !kernels.clock) return std::nullopt;
    return kernels.clock->scet_of(time.seconds, *kernels.leaps, kernels.partition);
}

std::string time_text(const PacketTime& time, const TimeKernels& kernels) {
    if (const auto scet = scet_of(time, kernels)) return scet->text();
    if (time.epoch.empty() && kernels.clock) return "undefined";
    return datum_text(time.seconds);
}

}  // namespace aeolis::telemetry
