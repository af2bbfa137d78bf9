// SPDX-License-Identifier: Apache-2.0
#include "telemetry/link_counters.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

constexpr std::int64_t microseconds_a_second = 1'000'000;

std::int64_t whole_seconds(Ert at) {
    return at.microseconds / microseconds_a_second;
}

}  // namespace

SequenceCounters& SequenceCounters::operator+=(const SequenceCounters& other) {
    received += other.received;
    gaps += other.gaps;
    missing += other.missing;
    repeated += other.repeated;
    late += other.late;
    restarts += other.restarts;
    wraps += other.wraps;
    return *this;
}

LinkCounters& LinkCounters::operator+=(const SequenceCounters& frames_of_channel) {
    gaps += frames_of_channel.gaps;
    missing_frames += frames_of_channel.missing;
    repeated_frames += frames_of_channel.repeated;
    late_frames += frames_of_channel.late;
    restarts += frames_of_channel.restarts;
    return *this;
}

LinkCounters& LinkCounters::operator+=(const LinkCounters& other) {
    octets += other.octets;
    frames += other.frames;
    bad_crc += other.bad_crc;
    bad_header += other.bad_header;
    skipped_octets += other.skipped_octets;
    gaps += other.gaps;
    missing_frames += other.missing_frames;
    repeated_frames += other.repeated_frames;
    late_frames += other.late_frames;
    restarts += other.restarts;
    cut_frames += other.cut_frames;
    slips += other.slips;
    other_data_frames += other.other_data_frames;
    corrected_headers += other.corrected_headers;
    corrected_frames += other.corrected_frames;
    corrected_symbols += other.corrected_symbols;
    uncorrectable_frames += other.uncorrectable_frames;
    forgotten_channels += other.forgotten_channels;
    return *this;
}

void RateMeter::add(Ert at, std::uint64_t amount) {
    const std::int64_t now_s = std::max(whole_seconds(at), newest_s_);
    const auto passed = std::min<std::int64_t>(now_s - newest_s_, places);
    for (std::int64_t i = 0; i < passed; ++i) amounts_[static_cast<std::size_t>(now_s - i) % places] = 0;
    newest_s_ = now_s;
    amounts_[static_cast<std::size_t>(now_s) % places] += amount;
}

double RateMeter::per_second(Ert now) const {
    const std::int64_t now_s = std::max(whole_seconds(now), newest_s_);
    std::uint64_t sum = 0;
    for (std::int64_t second = now_s - seconds; second < now_s; ++second)
        if (second >= 0 && second <= newest_s_ && newest_s_ - second < static_cast<std::int64_t>(places))
            sum += amounts_[static_cast<std::size_t>(second) % places];
    return static_cast<double>(sum) / static_cast<double>(seconds);
}

}  // namespace aeolis::telemetry
