// SPDX-License-Identifier: Apache-2.0
#include "common/cltu.hpp"

#include <algorithm>
#include <array>

namespace aeolis {
namespace {

constexpr std::array<std::uint8_t, 2> cltu_start{0xEB, 0x90};
constexpr std::array<std::uint8_t, 8> cltu_tail{0xC5, 0xC5, 0xC5, 0xC5, 0xC5, 0xC5, 0xC5, 0x79};
constexpr std::uint8_t cltu_fill = 0x55;

/// Remainders by x^7 + x^6 + x^2 + 1, in bits 7 … 1, indexed by the remainder so far xor the next octet.
constexpr std::array<std::uint8_t, 256> make_bch_table() {
    std::array<std::uint8_t, 256> table{};
    for (unsigned octet = 0; octet < 256; ++octet) {
        unsigned word = octet;
        for (int bit = 0; bit < 8; ++bit) word = (word & 0x80) != 0 ? (word << 1) ^ 0x18A : word << 1;
        table[octet] = static_cast<std::uint8_t>(word & 0xFE);
    }
    return table;
}
constexpr auto bch_table = make_bch_table();

}  // namespace

std::uint8_t bch_parity_octet(std::span<const std::uint8_t, cltu_block_information_octets> information) {
    std::uint8_t remainder = 0;
    for (const std::uint8_t octet : information) remainder = bch_table[remainder ^ octet];
    return static_cast<std::uint8_t>(~remainder & 0xFE);
}

std::size_t write_cltu(std::span<const std::uint8_t> information, std::span<std::uint8_t> into) {
    const std::size_t size = cltu_octets(information.size());
    AEOLIS_CHECK(!information.empty() && into.size() >= size);
    auto at = std::copy(cltu_start.begin(), cltu_start.end(), into.begin());
    while (!information.empty()) {
        std::array<std::uint8_t, cltu_block_information_octets> block{};
        block.fill(cltu_fill);
        const std::size_t now = std::min(information.size(), block.size());
        std::copy_n(information.begin(), now, block.begin());
        information = information.subspan(now);
        at = std::copy(block.begin(), block.end(), at);
        *at++ = bch_parity_octet(block);
    }
    std::copy(cltu_tail.begin(), cltu_tail.end(), at);
    return size;
}

Parsed<std::size_t> read_cltu(std::span<const std::uint8_t> cltu, std::span<std::uint8_t> into) {
    if (cltu.size() < cltu_start.size()) return Malformed::too_short;
    if (!std::equal(cltu_start.begin(), cltu_start.end(), cltu.begin())) return Malformed::no_start;
    std::size_t written = 0;
    for (auto rest = cltu.subspan(cltu_start.size()); rest.size() >= cltu_block_octets;
         rest = rest.subspan(cltu_block_octets)) {
        const auto information = rest.first<cltu_block_information_octets>();
        if (bch_parity_octet(information) != rest[cltu_block_information_octets]) {
            if (written == 0) return Malformed::bad_checksum;
            return written;
        }
        if (into.size() - written < information.size()) return Malformed::too_long;
        std::copy(information.begin(), information.end(), into.begin() + static_cast<std::ptrdiff_t>(written));
        written += information.size();
    }
    return Malformed::too_short;
}

}  // namespace aeolis
