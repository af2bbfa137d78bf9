// SPDX-License-Identifier: Apache-2.0
#include "telemetry/sync_search.hpp"

#include "common/check.hpp"
#include "common/proximity_frame.hpp"
#include "common/tm_frame.hpp"

#include <array>
#include <bit>

namespace aeolis::telemetry {
namespace {

constexpr unsigned octet_bits = 8, marker_bits = 32;

template <std::size_t size>
constexpr std::uint32_t marker_word_of(const std::array<std::uint8_t, size>& marker) {
    std::uint32_t word = 0;
    for (const std::uint8_t octet : marker) word = word << octet_bits | octet;
    return word;
}

constexpr std::uint32_t marker_word() {
    return marker_word_of(attached_sync_marker);
}

/// By the octet behind the one in which a marker of 24 bits begins, how it lies: 1 + 2 shift + inverted; 0: it is none.
constexpr std::array<std::uint8_t, 256> alignments_by_second(std::uint32_t marker) {
    std::array<std::uint8_t, 256> alignments{};
    for (unsigned shift = 0; shift < octet_bits; ++shift)
        for (unsigned inverted = 0; inverted < 2; ++inverted) {
            const std::uint32_t octet = (inverted != 0 ? ~marker : marker) >> (octet_bits + shift) & 0xFF;
            auto& alignment = alignments.at(octet);
            AEOLIS_CHECK(alignment == 0);  // each octet tells one
            alignment = static_cast<std::uint8_t>(1 + 2 * shift + inverted);
        }
    return alignments;
}

}  // namespace

void align(std::span<const std::uint8_t> octets, std::size_t first, std::size_t size, const BitAlignment& alignment,
           std::vector<std::uint8_t>& into) {
    AEOLIS_CHECK(octets.size() >= first + size + (alignment.shift > 0 ? 1 : 0));
    const unsigned inverted = alignment.inverted ? 0xFFU : 0U;
    into.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        unsigned octet = octets[first + i];
        if (alignment.shift > 0)
            octet = octet << alignment.shift | unsigned{octets[first + i + 1]} >> (octet_bits - alignment.shift);
        into[i] = static_cast<std::uint8_t>((octet ^ inverted) & 0xFFU);
    }
}

unsigned marker_errors(std::span<const std::uint8_t> octets, const BitAlignment& alignment) {
    const std::size_t needed = attached_sync_marker.size() + (alignment.shift > 0 ? 1 : 0);
    if (octets.size() < needed) return marker_bits;
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < needed; ++i) word = word << octet_bits | octets[i];
    if (alignment.shift > 0) word >>= octet_bits - alignment.shift;
    const auto sent = static_cast<std::uint32_t>(word) ^ (alignment.inverted ? ~std::uint32_t{0} : 0U);
    return static_cast<unsigned>(std::popcount(sent ^ marker_word()));
}

std::optional<MarkerFound> find_marker(std::span<const std::uint8_t> octets, std::size_t from) {
    constexpr std::uint32_t marker = marker_word();
    std::uint64_t word = 0;  // the last five octets
    for (std::size_t at = from; at < octets.size(); ++at) {
        word = word << octet_bits | octets[at];
        if (at < from + attached_sync_marker.size()) continue;
        for (unsigned shift = 0; shift < octet_bits; ++shift) {
            const auto sent = static_cast<std::uint32_t>(word >> (octet_bits - shift));
            if (sent == marker || sent == ~marker)
                return MarkerFound{at - attached_sync_marker.size(), {shift, sent != marker}};
        }
    }
    return std::nullopt;
}

std::optional<MarkerFound> find_pltu_marker(std::span<const std::uint8_t> octets, std::size_t from) {
    constexpr std::uint32_t marker = marker_word_of(pltu_marker), whole = 0xFFFFFF;
    constexpr auto alignments = alignments_by_second(marker);
    constexpr std::size_t size = pltu_marker.size();
    for (std::size_t octet = from; octet + size <= octets.size(); ++octet) {
        const unsigned found = alignments[octets[octet + 1]];
        if (found == 0) continue;
        const BitAlignment alignment{(found - 1) / 2, (found - 1) % 2 != 0};
        if (alignment.shift > 0 && octet + size == octets.size()) continue;
        std::uint32_t four = 0;
        for (std::size_t i = 0; i <= size; ++i)
            four = four << octet_bits | (octet + i < octets.size() ? octets[octet + i] : 0U);
        const std::uint32_t sent = (alignment.inverted ? ~four : four) >> (octet_bits - alignment.shift) & whole;
        if (sent == marker) return MarkerFound{octet, alignment};
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
