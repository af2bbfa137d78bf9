// SPDX-License-Identifier: Apache-2.0
#include "common/ck.hpp"

#include "common/daf.hpp"

#include <cmath>
#include <cstdio>

namespace aeolis {
namespace {

constexpr std::int32_t pointing_type = 3;
constexpr std::size_t quaternion_numbers = 4, rate_numbers = 3;
constexpr std::size_t time_directory_step = 100;

std::size_t time_directory_of(std::size_t times) {
    return (times - 1) / time_directory_step;
}
void add_times(std::vector<double>& data, const std::vector<double>& times) {
    data.insert(data.end(), times.begin(), times.end());
    for (std::size_t i = 1; i <= time_directory_of(times.size()); ++i)
        data.push_back(times[i * time_directory_step - 1]);
}

// Layout: pointings | times | every hundredth | intervals | every hundredth | number of intervals | of pointings.
Result<void> read_pointings(const DafArray& array, bool rates, CkSegment& segment) {
    const auto wrong = [&](const std::string& what) { return Error{"segment '" + array.name + "' " + what}; };
    const std::size_t size = array.data.size(), each = quaternion_numbers + (rates ? rate_numbers : 0);
    if (size < each + 4) return wrong("is too short for one pointing");
    const double pointings = array.data[size - 1], intervals = array.data[size - 2];
    const auto is_count = [&](double n) { return n >= 1.0 && n <= static_cast<double>(size) && n == std::floor(n); };
    if (!is_count(pointings) || !is_count(intervals)) return wrong("has an impossible number of pointings");
    const auto count = static_cast<std::size_t>(pointings), begins = static_cast<std::size_t>(intervals);
    const std::size_t times_at = count * each, begins_at = times_at + count + time_directory_of(count);
    if (size != begins_at + begins + time_directory_of(begins) + 2)
        return wrong("is not as long as its pointings make it");
    for (std::size_t i = 0; i < count; ++i) {
        CkSegment::Pointing pointing;
        pointing.sclk_ticks = array.data[times_at + i];
        for (std::size_t k = 0; k < quaternion_numbers; ++k) pointing.q_BA.at(k) = array.data[i * each + k];
        if (rates) {
            pointing.w_AB_A_rps.emplace();
            for (std::size_t k = 0; k < rate_numbers; ++k)
                pointing.w_AB_A_rps->at(k) = array.data[i * each + quaternion_numbers + k];
        }
        if (i > 0 && !(pointing.sclk_ticks > segment.pointings.back().sclk_ticks))
            return wrong("has times that do not ascend");
        segment.pointings.push_back(pointing);
    }
    for (std::size_t i = 0; i < begins; ++i) segment.intervals_at_ticks.push_back(array.data[begins_at + i]);
    return {};
}

}  // namespace

Result<std::vector<CkSegment>> read_ck(std::span<const std::uint8_t> file) {
    const auto daf = read_daf(file);
    if (!daf) return daf.error();
    if (daf->kind != "CK") return Error{"is a kernel of the kind " + daf->kind + ", not CK"};
    std::vector<CkSegment> segments;
    for (const DafArray& array : daf->arrays) {
        if (array.numbers.size() != 2 || array.integers.size() != 4) return Error{"has summaries that no CK has"};
        CkSegment segment;
        segment.name = array.name;
        segment.structure = array.integers[0];
        segment.frame = array.integers[1];
        segment.type = array.integers[2];
        segment.start_ticks = array.numbers[0];
        segment.stop_ticks = array.numbers[1];
        if (segment.type == pointing_type) {
            if (const auto read = read_pointings(array, array.integers[3] == 1, segment); !read) return read.error();
        }
        segments.push_back(std::move(segment));
    }
    return segments;
}

Result<std::vector<std::uint8_t>> write_ck(const std::vector<CkSegment>& segments, std::string_view program) {
    Daf daf{"CK", {}};
    if (segments.empty()) return Error{"no segment is to be written"};
    for (const CkSegment& segment : segments) {
        if (segment.pointings.empty() || segment.intervals_at_ticks.empty())
            return Error{"segment '" + segment.name + "' has no pointing or no interval"};
        const bool rates = segment.pointings.front().w_AB_A_rps.has_value();
        DafArray array;
        array.name = segment.name;
        array.numbers = {segment.start_ticks, segment.stop_ticks};
        array.integers = {segment.structure, segment.frame, pointing_type, rates ? 1 : 0};
        std::vector<double> times;
        for (const auto& pointing : segment.pointings) {
            if (pointing.w_AB_A_rps.has_value() != rates)
                return Error{"segment '" + segment.name + "' has rates with some of its pointings only"};
            array.data.insert(array.data.end(), pointing.q_BA.begin(), pointing.q_BA.end());
            if (rates) array.data.insert(array.data.end(), pointing.w_AB_A_rps->begin(), pointing.w_AB_A_rps->end());
            times.push_back(pointing.sclk_ticks);
        }
        add_times(array.data, times);
        add_times(array.data, segment.intervals_at_ticks);
        array.data.push_back(static_cast<double>(segment.intervals_at_ticks.size()));
        array.data.push_back(static_cast<double>(segment.pointings.size()));
        daf.arrays.push_back(std::move(array));
    }
    return write_daf(daf, program);
}

std::string clock_kernel(std::int32_t clock, EphemerisTime at, double seconds, double rate) {
    const int number = -clock;
    std::string text(2048, '\0');
    // One partition of whole seconds and 1/65536 s. The coefficients are the first tick, its ephemeris time,
    // and seconds of TDB a second of the clock.
    const int length = std::snprintf(text.data(), text.size(),
                                     "KPL/SCLK\n\n\\begindata\n\n"
                                     "SCLK_KERNEL_ID             = ( @2000-01-01 )\n"
                                     "SCLK_DATA_TYPE_%d         = ( 1 )\n"
                                     "SCLK01_TIME_SYSTEM_%d     = ( 1 )\n"
                                     "SCLK01_N_FIELDS_%d        = ( 2 )\n"
                                     "SCLK01_MODULI_%d          = ( 4294967296 65536 )\n"
                                     "SCLK01_OFFSETS_%d         = ( 0 0 )\n"
                                     "SCLK01_OUTPUT_DELIM_%d    = ( 2 )\n"
                                     "SCLK_PARTITION_START_%d   = ( 0.0 )\n"
                                     "SCLK_PARTITION_END_%d     = ( 2.81474976710655E+14 )\n"
                                     "SCLK01_COEFFICIENTS_%d    = ( 0.0 %.15g %.15g )\n\n"
                                     "\\begintext\n",
                                     number, number, number, number, number, number, number, number, number,
                                     at.seconds - seconds * rate, rate);
    text.resize(static_cast<std::size_t>(length));
    return text;
}

}  // namespace aeolis
