// SPDX-License-Identifier: Apache-2.0
#include "telemetry/frame_order.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <functional>
#include <string_view>

namespace aeolis::telemetry {
namespace {

constexpr std::uint32_t short_modulus = 256;  // of TM and Proximity-1: a count that goes back may as well have wrapped
constexpr std::uint32_t wrapped_part = 16;    // chosen: a longer count has wrapped if less than a 16th of it is missing

std::size_t hash_of(std::span<const std::uint8_t> octets) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): octets as characters, to hash them
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(octets.data()), octets.size()});
}

}  // namespace

FrameOrder::Placed FrameOrder::place(std::uint32_t count, std::uint32_t modulus, std::span<const std::uint8_t> octets,
                                     SequenceCounters& counters) {
    AEOLIS_CHECK(modulus > 0 && (modulus & (modulus - 1)) == 0);
    const std::uint32_t mask = modulus - 1;
    const auto hash = hash_of(octets);
    ++counters.received;
    if (last_ == 0) {
        begin(count, modulus, hash);
        return {};
    }
    const auto last_count = static_cast<std::uint32_t>(last_) & mask;
    const std::uint32_t behind = (last_count - count) & mask;
    if (behind < std::min(window_max, modulus / 4))
        return place_earlier(last_ - behind, count, modulus, hash, counters);
    const std::uint32_t missing = (count - last_count - 1) & mask;
    if (modulus > short_modulus && count < last_count && missing > modulus / wrapped_part) {
        ++counters.restarts;
        begin(count, modulus, hash);
        return {.place = FramePlace::restarted};
    }
    const auto turns = last_ / modulus;
    last_ += missing + std::uint64_t{1};
    counters.wraps += last_ / modulus - turns;
    seen_.at(last_ % window_max) = {last_, hash};
    if (missing == 0) return {};
    ++counters.gaps;
    counters.missing += missing;
    return {.place = FramePlace::after_gap, .missing = missing};
}

void FrameOrder::begin(std::uint32_t count, std::uint32_t modulus, std::size_t hash) {
    first_ = last_ = std::uint64_t{modulus} + count;  // above 0, and as much of it is the count
    seen_ = {};
    seen_.at(last_ % window_max) = {last_, hash};
}

FrameOrder::Placed FrameOrder::place_earlier(std::uint64_t index, std::uint32_t count, std::uint32_t modulus,
                                             std::size_t hash, SequenceCounters& counters) {
    auto& seen = seen_.at(index % window_max);
    if (seen.index != index) {
        seen = {index, hash};
        ++counters.late;
        if (index > first_) --counters.missing;  // as which it was counted
        return {.place = FramePlace::late};
    }
    if (seen.hash == hash) {
        ++counters.repeated;
        return {.place = FramePlace::repeated};
    }
    ++counters.restarts;
    begin(count, modulus, hash);
    return {.place = FramePlace::restarted};
}

}  // namespace aeolis::telemetry
