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

/// FNV-1a over words of eight octets, the last one filled up with zeros. [fnv]
std::uint64_t checksum(std::span<const std::uint8_t> octets) {
    std::uint64_t sum = 0xCBF29CE484222325U;
    for (std::size_t at = 0; at < octets.size(); at += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, octets.data() + at, std::min(sizeof word, octets.size() - at));
        sum = (sum ^ word) * 0x100000001B3U;
        sum ^= sum >> 29U;  // a multiplication alone never brings high bits down
    }
    return sum;
}

}  // namespace

void StateFrame::seal(std::span<std::uint8_t> room, std::size_t checksum_at) {
    const auto size = static_cast<std::uint16_t>(checksum_at + checksum_octets);
    std::memcpy(room.data(), &dictionary_id, sizeof dictionary_id);
    std::memcpy(room.data() + sizeof dictionary_id, &size, sizeof size);
    const std::uint64_t sum = checksum(room.first(checksum_at));
    std::memcpy(room.data() + checksum_at, &sum, sizeof sum);
    octets_.append(room.first(size));
}

std::optional<StateFrame> StateFrame::read(std::span<const std::uint8_t> octets) {
    if (octets.size() < prefix_octets + checksum_octets || octets.size() > state_octets_max) return std::nullopt;
    const std::size_t checksum_at = octets.size() - checksum_octets;
    if (number_at<std::uint16_t>(octets, 0) != dictionary_id || number_at<std::uint16_t>(octets, 2) != octets.size() ||
        number_at<std::uint64_t>(octets, checksum_at) != checksum(octets.first(checksum_at)))
        return std::nullopt;
    StateFrame frame;
    frame.octets_.append(octets);
    return frame;
}

StateHeader StateFrame::header() const {
    StateHeader header;
    StateExchange exchange{content()};
    exchange(header);
    return header;
}

std::optional<StateFrame> StateAssembly::on(const StatePart& part) {
    if (part.index == 0) {
        octets_.clear();
        next_ = 0;
        time_ = part.time;
    }
    const bool fits = part.size <= state_part_octets_max && part.size <= octets_.capacity() - octets_.size();
    if (part.index != next_ || part.time != time_ || part.index >= part.count || !fits) {
        next_ = 0;
        octets_.clear();
        return std::nullopt;
    }
    octets_.append(std::span{part.octets}.first(part.size));
    if (++next_ < part.count) return std::nullopt;
    next_ = 0;
    return StateFrame::read(octets_.span());
}

}  // namespace aeolis::flight
