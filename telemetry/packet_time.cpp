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
constexpr double us_in_second = 1.0e6;

/// The instant that an epoch written as a date is: midnight without a time, UTC without an offset of hours from it.
std::optional<Scet> instant_of(const std::string& epoch) {
    constexpr std::size_t date_size = 10, offset_size = 6;  // 2000-01-01, +01:00
    if (epoch.size() == date_size) return scet_from_text(epoch + "T00:00:00");
    const auto utc = scet_from_text(epoch);
    if (utc || epoch.size() < date_size + offset_size) return utc;
    const std::string offset = epoch.substr(epoch.size() - offset_size);
    const bool behind = offset[0] == '-';  // of UTC
    if ((offset[0] != '+' && !behind) || offset[3] != ':') return std::nullopt;
    for (const std::size_t digit : {1U, 2U, 4U, 5U})
        if (offset[digit] < '0' || offset[digit] > '9') return std::nullopt;
    const auto local = scet_from_text(epoch.substr(0, epoch.size() - offset_size));
    if (!local) return std::nullopt;
    const std::int64_t minutes = std::stoi(offset.substr(1, 2)) * 60 + std::stoi(offset.substr(4, 2));
    return Scet{local->microseconds + (behind ? 1 : -1) * minutes * 60'000'000};
}

/// Seconds that have passed since a date: with leap seconds, as a counter on board counts them. UTC has seconds of
/// their length from 1972 on. Of the epochs before, 1970 is POSIX's, and 1958, where UTC and TAI met, TAI's.
std::optional<UtcInstant> since_date(Scet epoch, double seconds, const TimeKernels& kernels) {
    const double epoch_s = static_cast<double>(epoch.microseconds) / us_in_second;
    if (epoch_s == unix_epoch_s) return scet_of({seconds, "UNIX"}, kernels);
    if (!kernels.leaps) return std::nullopt;
    if (epoch_s == tai_epoch_s) return kernels.leaps->utc_of_tai(tai_epoch_s + seconds);
    const auto tai_s = kernels.leaps->tai_of_utc({epoch.microseconds, false});
    return tai_s ? kernels.leaps->utc_of_tai(*tai_s + seconds) : std::nullopt;
}

/// The instant of days and seconds of the day, by the calendar alone; none where the epoch is no known midnight.
std::optional<UtcInstant> of_days(const PacketTime& time) {
    constexpr double gps_epoch_s = -630763200.0;  // 1980-01-06 UTC
    std::optional<double> epoch_s;
    if (time.epoch == "UNIX" || time.epoch == "POSIX") epoch_s = unix_epoch_s;
    if (time.epoch == "TAI") epoch_s = tai_epoch_s;  // of the same date as that of UTC
    if (time.epoch == "GPS") epoch_s = gps_epoch_s;
    if (const auto date = instant_of(time.epoch)) epoch_s = static_cast<double>(date->microseconds) / us_in_second;
    if (!epoch_s) return std::nullopt;
    const double second = *epoch_s + time.seconds - (time.leap_second ? 1.0 : 0.0);
    return UtcInstant{static_cast<std::int64_t>(std::llround(second * us_in_second)), time.leap_second};
}

}  // namespace

std::optional<UtcInstant> scet_of(const PacketTime& time, const TimeKernels& kernels) {
    if (!(std::abs(time.seconds) < seconds_max)) return std::nullopt;
    if (time.days_of_utc && !time.epoch.empty()) return of_days(time);
    if (time.epoch == "UNIX" || time.epoch == "POSIX")
        return UtcInstant{static_cast<std::int64_t>(std::llround((unix_epoch_s + time.seconds) * 1.0e6)), false};
    if (const auto date = instant_of(time.epoch)) return since_date(*date, time.seconds, kernels);
    if (!kernels.leaps) return std::nullopt;
    if (time.epoch == "GPS") return kernels.leaps->utc_of_tai(gps_epoch_tai_s + time.seconds);
    if (time.epoch == "TAI") return kernels.leaps->utc_of_tai(tai_epoch_s + time.seconds);
    if (time.epoch == "J2000") return kernels.leaps->utc_of_tt(time.seconds);
    if (!time.epoch.empty() || !kernels.clock) return std::nullopt;
    return kernels.clock->scet_of(time.seconds, *kernels.leaps, kernels.partition);
}

std::string time_text(const PacketTime& time, const TimeKernels& kernels) {
    if (const auto scet = scet_of(time, kernels)) return scet->text();
    if (time.epoch.empty() && kernels.clock) return "undefined";
    const std::string seconds = datum_text(time.seconds);
    const bool named = time.epoch.empty() || time.epoch == "GPS" || time.epoch == "TAI" || time.epoch == "UNIX";
    return named ? seconds : seconds + " s after " + time.epoch;
}

}  // namespace aeolis::telemetry
