// SPDX-License-Identifier: Apache-2.0
#include "flight/cross_string/state_frame.hpp"

#include "generated/dictionary_flight.hpp"

namespace aeolis::flight {
namespace {

template <typename T>
T number_at(std::span<const std::uint8_t> octets, std::size_t at) {
    T value;
    std::memcpy(&value, octets.data() + at, sizeof value);
    return value;
}

/// FNV-1a over words of eight octets, the last padded with zeros, in four independent lanes; the lanes themselves are
/// hashed last. [fnv]
std::uint64_t checksum(std::span<const std::uint8_t> octets) {
    constexpr std::size_t lanes = 4;
    constexpr std::size_t row = lanes * sizeof(std::uint64_t);
    constexpr std::uint64_t prime = 0x100000001B3U, offset_basis = 0xCBF29CE484222325U;
    constexpr unsigned high_bits = 29;
    const auto add = [](std::uint64_t& sum, std::uint64_t word) {
        sum = (sum ^ word) * prime;
        sum ^= sum >> high_bits;  // a multiplication alone never moves high bits down
    };
    std::array<std::uint64_t, lanes> sums{offset_basis, 1, 2, 3};
    // Not a loop: g++ would vectorize it, and SSE2 multiplies words of eight octets by shifts, four times as slowly.
    const auto add_row = [&](const std::array<std::uint64_t, lanes>& words) {
        add(sums[0], words[0]);
        add(sums[1], words[1]);
        add(sums[2], words[2]);
        add(sums[3], words[3]);
    };
    std::array<std::uint64_t, lanes> words{};
    std::size_t at = 0;
    for (; at + row <= octets.size(); at += row) {
        std::memcpy(words.data(), octets.data() + at, row);
        add_row(words);
    }
    if (at < octets.size()) {
        words.fill(0);
        std::memcpy(words.data(), octets.data() + at, octets.size() - at);
        add_row(words);
    }
    std::uint64_t all = octets.size();
    for (const std::uint64_t sum : sums) add(all, sum);
    return all;
}

}  // namespace

void StateFrame::seal(std::size_t checksum_at) {
    const auto size = static_cast<std::uint16_t>(checksum_at + checksum_octets);
    octets_.resize(size);
    const std::span<std::uint8_t> frame = octets_.span();
    std::memcpy(frame.data(), &dictionary_id, sizeof dictionary_id);
    std::memcpy(frame.data() + sizeof dictionary_id, &size, sizeof size);
    const std::uint64_t sum = checksum(frame.first(checksum_at));
    std::memcpy(frame.data() + checksum_at, &sum, sizeof sum);
}

std::optional<StateFrame> StateFrame::read(std::span<const std::uint8_t> octets) {
    std::optional<StateFrame> frame{std::in_place};
    if (!frame->replace(octets)) frame.reset();
    return frame;
}

bool StateFrame::replace(std::span<const std::uint8_t> octets) {
    if (octets.size() < prefix_octets + checksum_octets || octets.size() > state_octets_max) return false;
    const std::size_t checksum_at = octets.size() - checksum_octets;
    if (number_at<std::uint16_t>(octets, 0) != dictionary_id || number_at<std::uint16_t>(octets, 2) != octets.size() ||
        number_at<std::uint64_t>(octets, checksum_at) != checksum(octets.first(checksum_at)))
        return false;
    octets_.clear();
    octets_.append(octets);
    return true;
}

StateHeader StateFrame::header_of(std::span<const std::uint8_t> octets) {
    StateHeader header;
    if (octets.size() < prefix_octets) return header;
    StateExchange exchange{octets.subspan(prefix_octets)};
    exchange(header);
    return header;
}

std::optional<StateFrame> StateAssembly::on(const StatePart& part) {
    if (!take(part)) return std::nullopt;
    return StateFrame::read(octets_.span());
}

bool StateAssembly::take(const StatePart& part) {
    if (part.index == 0) {
        octets_.clear();
        next_ = 0;
        time_ = part.time;
    }
    const bool fits = part.size <= state_part_octets_max && part.size <= octets_.capacity() - octets_.size();
    if (part.index != next_ || part.time != time_ || part.index >= part.count || !fits) {
        next_ = 0;
        octets_.clear();
        return false;
    }
    octets_.append(std::span{part.octets}.first(part.size));
    if (++next_ < part.count) return false;
    next_ = 0;
    return true;
}

}  // namespace aeolis::flight
