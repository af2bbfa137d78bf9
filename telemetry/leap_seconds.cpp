// SPDX-License-Identifier: Apache-2.0
#include "telemetry/leap_seconds.hpp"

#include "common/time.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {
namespace {

constexpr std::size_t leap_seconds_max = 10'000;  // chosen
constexpr double utc_s_max = 1.0e11;              // 3000 years: the limit of the calendar's text
constexpr std::size_t seconds_position = 15;      // of the two digits in 2012-219T05:17:57.123

std::int64_t microseconds_of(double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1.0e6));
}

}  // namespace

std::string UtcInstant::text() const {
    std::string text = day_of_year_text(Scet{microseconds});
    if (leap_second) text.replace(seconds_position, 2, "60");
    return text;
}

Result<LeapSeconds> LeapSeconds::read(const TextKernel& kernel) {
    const auto delta = kernel.numbers("DELTET/DELTA_T_A", 1);
    const auto amplitude = kernel.numbers("DELTET/K", 1);
    const auto eccentricity = kernel.numbers("DELTET/EB", 1);
    const auto anomaly = kernel.numbers("DELTET/M", 2);
    const auto table = kernel.numbers("DELTET/DELTA_AT", 2);
    for (const auto* each : {&delta, &amplitude, &eccentricity, &anomaly, &table})
        if (!*each) return each->error();
    LeapSeconds leaps;
    leaps.tt_minus_tai_s_ = (*delta)[0];
    leaps.amplitude_s_ = (*amplitude)[0];
    leaps.eccentricity_ = (*eccentricity)[0];
    leaps.anomaly_ = (*anomaly)[0];
    leaps.anomaly_rate_ = (*anomaly)[1];
    const auto wrong = [&](const std::string& what) {
        return Error{kernel.file() + ":" + std::to_string(kernel.find("DELTET/DELTA_AT")->line) + ": DELTET/DELTA_AT " +
                     what};
    };
    if (table->size() % 2 != 0 || table->size() > 2 * leap_seconds_max)
        return wrong("is not a list of pairs: seconds, date");
    for (std::size_t i = 0; i < table->size(); i += 2) {
        const Step step{(*table)[i + 1], (*table)[i]};
        if (!leaps.steps_.empty() && step.utc_s <= leaps.steps_.back().utc_s)
            return wrong("is not in the order of its dates");
        if (std::abs(step.utc_s) > utc_s_max || std::abs(step.tai_minus_utc_s) > 86400.0)
            return wrong("holds no possible number");
        leaps.steps_.push_back(step);
    }
    return leaps;
}

double LeapSeconds::tdb_minus_tt(double tdb_s) const {
    const double mean = anomaly_ + anomaly_rate_ * tdb_s;
    return amplitude_s_ * std::sin(mean + eccentricity_ * std::sin(mean));
}

std::optional<UtcInstant> LeapSeconds::utc_of_tai(double tai_s) const {
    if (!(std::abs(tai_s) < utc_s_max)) return std::nullopt;
    // Whole microseconds from here on, so that later rounding cannot cross a leap second.
    const std::int64_t tai_us = microseconds_of(tai_s);
    const auto after = std::ranges::upper_bound(
        steps_, tai_us, {}, [](const Step& step) { return microseconds_of(step.utc_s + step.tai_minus_utc_s); });
    if (after == steps_.begin()) return std::nullopt;
    const std::int64_t utc_us = tai_us - microseconds_of(std::prev(after)->tai_minus_utc_s);
    // An inserted second lies after midnight by the old count and before midnight by the new one.
    if (after != steps_.end() && utc_us >= microseconds_of(after->utc_s)) return UtcInstant{utc_us - 1'000'000, true};
    return UtcInstant{utc_us, false};
}

std::optional<double> LeapSeconds::tai_of_utc(const UtcInstant& utc) const {
    const double utc_s = static_cast<double>(utc.microseconds) * 1.0e-6;
    const auto after = std::ranges::upper_bound(steps_, utc_s, {}, &Step::utc_s);
    if (after == steps_.begin()) return std::nullopt;
    return utc_s + (utc.leap_second ? 1.0 : 0.0) + std::prev(after)->tai_minus_utc_s;
}

std::optional<double> LeapSeconds::tdb_of_utc(const UtcInstant& utc) const {
    const auto tai_s = tai_of_utc(utc);
    if (!tai_s) return std::nullopt;
    const double tt_s = *tai_s + tt_minus_tai_s_;
    return tt_s + tdb_minus_tt(tt_s);
}

}  // namespace aeolis::telemetry
