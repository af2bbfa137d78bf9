// SPDX-License-Identifier: Apache-2.0
// Octets from hexadecimal text, and random octets.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string_view>
#include <vector>

namespace aeolis::test {

/// "EB90 2062" → EB 90 20 62
inline std::vector<std::uint8_t> hex(std::string_view text) {
    std::vector<std::uint8_t> octets;
    unsigned value = 0;
    int digits = 0;
    for (const char c : text) {
        if (c == ' ') continue;
        const int digit = c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10;
        value = value * 16 + static_cast<unsigned>(digit);
        if (++digits % 2 == 0) {
            octets.push_back(static_cast<std::uint8_t>(value));
            value = 0;
        }
    }
    return octets;
}

inline std::vector<std::uint8_t> random_octets(std::mt19937& random, std::size_t size) {
    std::vector<std::uint8_t> octets(size);
    for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
    return octets;
}

inline std::vector<std::uint8_t> copy_of(std::span<const std::uint8_t> octets) {
    return {octets.begin(), octets.end()};
}

/// The octets behind `shift` bits of 0, 0 … 7, filled up with 0; with all bits inverted.
inline std::vector<std::uint8_t> shifted(std::span<const std::uint8_t> octets, unsigned shift, bool inverted) {
    std::vector<std::uint8_t> all(octets.size() + (shift > 0 ? 1 : 0));
    for (std::size_t i = 0; i < all.size(); ++i) {
        const unsigned before = i > 0 ? octets[i - 1] : 0U, here = i < octets.size() ? octets[i] : 0U;
        all[i] = static_cast<std::uint8_t>((before << 8U | here) >> shift ^ (inverted ? 0xFFU : 0U));
    }
    return all;
}

}  // namespace aeolis::test
