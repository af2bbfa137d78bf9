// SPDX-License-Identifier: Apache-2.0
#include "common/randomiser.hpp"

#include <array>
#include <bit>
#include <cstddef>

namespace aeolis {
namespace {

using Sequence = std::array<std::uint8_t, 255>;  // 255 bits repeat after 255 octets

/// Shift register, initially eight ones: bit 0 is output, and the sum of the bits in `taps` is shifted in.
constexpr Sequence sequence_of(unsigned taps) {
    Sequence octets{};
    unsigned state = 0xFF;
    for (auto& octet : octets)
        for (int bit = 7; bit >= 0; --bit) {
            octet = static_cast<std::uint8_t>(octet | ((state & 1U) << bit));
            state = (state >> 1) | ((static_cast<unsigned>(std::popcount(state & taps)) & 1U) << 7);
        }
    return octets;
}

constexpr Sequence tm_sequence = sequence_of(0b1010'1001);  // x^8 + x^7 + x^5 + x^3 + 1
constexpr Sequence tc_sequence = sequence_of(0b0101'1111);  // x^8 + x^6 + x^4 + x^3 + x^2 + x + 1

void add(const Sequence& sequence, std::span<std::uint8_t> octets) {
    std::size_t at = 0;
    for (auto& octet : octets) {
        octet = static_cast<std::uint8_t>(octet ^ sequence[at]);
        at = at + 1 == sequence.size() ? 0 : at + 1;
    }
}

}  // namespace

void randomise_tm(std::span<std::uint8_t> octets) {
    add(tm_sequence, octets);
}
void randomise_tc(std::span<std::uint8_t> octets) {
    add(tc_sequence, octets);
}

}  // namespace aeolis
