// SPDX-License-Identifier: Apache-2.0
#include "telemetry/clock_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {
namespace {

constexpr double fields_max = 10.0;   // [naif-sclk]: no clock has more
constexpr double ticks_max = 1.0e17;  // chosen: far beyond a double's range of exact counts

Error clock_fault(const TextKernel& kernel, const std::string& name, const std::string& what) {
    const auto* variable = kernel.find(name);
    return Error{kernel.file() + ":" + std::to_string(variable == nullptr ? 1 : variable->line) + ": " + name + " " +
                 what};
}

}  // namespace

Result<ClockKernel> ClockKernel::read(const TextKernel& kernel) {
    constexpr std::string_view type_name = "SCLK_DATA_TYPE_";
    ClockKernel clock;
    for (const auto& [name, variable] : kernel.variables()) {
        if (!name.starts_with(type_name)) continue;
        if (!clock.spacecraft_.empty())
            return clock_fault(kernel, name, "is the clock of a second spacecraft: give a kernel of one");
        clock.spacecraft_ = name.substr(type_name.size());
    }
    if (clock.spacecraft_.empty())
        return Error{kernel.file() + ": it says no " + std::string{type_name} + "…: it is no SCLK kernel"};
    const std::string type = std::string{type_name} + clock.spacecraft_;
    const auto number = kernel.numbers(type, 1);
    if (!number) return number.error();
    if ((*number)[0] != 1.0) return clock_fault(kernel, type, "is not 1: other types of clock are not supported");
    const std::string system = "SCLK01_TIME_SYSTEM_" + clock.spacecraft_;
    if (kernel.find(system) != nullptr) {
        const auto word = kernel.numbers(system, 1);
        if (!word) return word.error();
        if ((*word)[0] != 1.0 && (*word)[0] != 2.0)
            return clock_fault(kernel, system, "is neither 1 (TDB) nor 2 (TDT)");
        clock.terrestrial_ = (*word)[0] == 2.0;
    }
    if (auto done = clock.read_fields(kernel); !done) return done.error();
    if (auto done = clock.read_partitions(kernel); !done) return done.error();
    if (auto done = clock.read_points(kernel); !done) return done.error();
    return clock;
}

Result<void> ClockKernel::read_fields(const TextKernel& kernel) {
    const std::string count_name = "SCLK01_N_FIELDS_" + spacecraft_;
    const auto count = kernel.numbers(count_name, 1);
    if (!count) return count.error();
    const double fields = (*count)[0];
    if (fields != std::floor(fields) || fields < 1.0 || fields > fields_max)
        return clock_fault(kernel, count_name, "is not a whole number from 1 to 10");
    const auto wanted = static_cast<std::size_t>(fields);
    const auto moduli = kernel.numbers("SCLK01_MODULI_" + spacecraft_, wanted);
    if (!moduli) return moduli.error();
    const auto offsets = kernel.numbers("SCLK01_OFFSETS_" + spacecraft_, wanted);
    if (!offsets) return offsets.error();
    double weight = 1.0;
    for (std::size_t i = wanted; i-- > 0;) {
        if ((*moduli)[i] != std::floor((*moduli)[i]) || (*moduli)[i] < 1.0 || (*moduli)[i] > ticks_max)
            return clock_fault(kernel, "SCLK01_MODULI_" + spacecraft_, "holds no possible number");
        offset_ticks_ += (*offsets)[i] * weight;
        if (i > 0) weight *= (*moduli)[i];
    }
    if (weight > ticks_max)
        return clock_fault(kernel, "SCLK01_MODULI_" + spacecraft_, "are more ticks than can be counted");
    ticks_per_count_ = weight;
    return {};
}

Result<void> ClockKernel::read_partitions(const TextKernel& kernel) {
    const std::string end_name = "SCLK_PARTITION_END_" + spacecraft_;
    const auto starts = kernel.numbers("SCLK_PARTITION_START_" + spacecraft_, 1);
    if (!starts) return starts.error();
    const auto ends = kernel.numbers(end_name, starts->size());
    if (!ends) return ends.error();
    double before = 0.0;
    for (std::size_t i = 0; i < starts->size(); ++i) {
        const Partition partition{(*starts)[i], (*ends)[i], before};
        if (partition.end_ticks <= partition.start_ticks || partition.start_ticks < 0.0 ||
            partition.end_ticks > ticks_max)
            return clock_fault(kernel, end_name,
                               "ends partition " + std::to_string(i + 1) + " before it begins, or nowhere");
        before += partition.end_ticks - partition.start_ticks;
        partitions_.push_back(partition);
    }
    return {};
}

Result<void> ClockKernel::read_points(const TextKernel& kernel) {
    const std::string name = "SCLK01_COEFFICIENTS_" + spacecraft_;
    const auto numbers = kernel.numbers(name, 3);
    if (!numbers) return numbers.error();
    if (numbers->size() % 3 != 0) return clock_fault(kernel, name, "is not a list of threes: ticks, time, rate");
    for (std::size_t i = 0; i < numbers->size(); i += 3) {
        const Point point{(*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]};
        if (!points_.empty() && (point.ticks <= points_.back().ticks || point.time_s < points_.back().time_s))
            return clock_fault(kernel, name, "is not in order at its point " + std::to_string(i / 3 + 1));
        if (point.rate_s <= 0.0)
            return clock_fault(kernel, name,
                               "has a rate that is not above 0 at its point " + std::to_string(i / 3 + 1));
        points_.push_back(point);
    }
    return {};
}

std::optional<double> ClockKernel::parallel_time_of(double count, std::optional<std::size_t> partition) const {
    const double ticks = count * ticks_per_count_ - offset_ticks_;
    auto in = partitions_.begin();
    if (partition) {
        if (*partition == 0 || *partition > partitions_.size()) return std::nullopt;
        in += static_cast<std::ptrdiff_t>(*partition - 1);
    } else {
        in = std::ranges::find_if(
            partitions_, [&](const Partition& each) { return ticks >= each.start_ticks && ticks <= each.end_ticks; });
    }
    if (in == partitions_.end() || !(ticks >= in->start_ticks && ticks <= in->end_ticks)) return std::nullopt;
    const double all_ticks = ticks - in->start_ticks + in->before_ticks;
    const auto after = std::ranges::upper_bound(points_, all_ticks, {}, &Point::ticks);
    if (after == points_.begin()) return std::nullopt;
    const Point& point = *std::prev(after);
    return point.time_s + (all_ticks - point.ticks) / ticks_per_count_ * point.rate_s;
}

std::optional<std::pair<double, std::size_t>> ClockKernel::count_at(double parallel_time_s) const {
    const auto after = std::ranges::upper_bound(points_, parallel_time_s, {}, &Point::time_s);
    if (after == points_.begin()) return std::nullopt;
    const Point& point = *std::prev(after);
    const double all_ticks = point.ticks + (parallel_time_s - point.time_s) / point.rate_s * ticks_per_count_;
    if (after != points_.end() && all_ticks >= after->ticks)
        return std::nullopt;  // skipped when the next point was set
    for (std::size_t i = 0; i < partitions_.size(); ++i) {
        const Partition& partition = partitions_[i];
        const double ticks = all_ticks - partition.before_ticks + partition.start_ticks;
        if (ticks >= partition.start_ticks && ticks <= partition.end_ticks)
            return std::pair{(ticks + offset_ticks_) / ticks_per_count_, i + 1};
    }
    return std::nullopt;
}

std::optional<UtcInstant> ClockKernel::scet_of(double count, const LeapSeconds& leaps,
                                               std::optional<std::size_t> partition) const {
    const auto time_s = parallel_time_of(count, partition);
    if (!time_s) return std::nullopt;
    return terrestrial_ ? leaps.utc_of_tt(*time_s) : leaps.utc_of_tdb(*time_s);
}

}  // namespace aeolis::telemetry
