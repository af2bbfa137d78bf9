// SPDX-License-Identifier: Apache-2.0
#include "common/crc.hpp"

#include <array>

namespace aeolis {
namespace {

template <typename Word, Word polynomial>
constexpr std::array<Word, 256> make_table() {
    constexpr unsigned top = sizeof(Word) * 8;
    std::array<Word, 256> table{};
    for (unsigned octet = 0; octet < 256; ++octet) {
        auto word = static_cast<Word>(static_cast<Word>(octet) << (top - 8));
        for (int bit = 0; bit < 8; ++bit) {
            const bool carry = (word >> (top - 1)) & 1U;
            word = static_cast<Word>(word << 1);
            if (carry) word = static_cast<Word>(word ^ polynomial);
        }
        table[octet] = word;
    }
    return table;
}

/// Table k is for an octet followed by k zero octets, so that one step takes eight octets. Finding frames in a stream
/// spends most of its time on their CRCs, and each packet's is made on board and checked on the ground.
template <typename Word, Word polynomial>
constexpr std::array<std::array<Word, 256>, 8> make_tables() {
    constexpr unsigned top = sizeof(Word) * 8;
    std::array<std::array<Word, 256>, 8> tables{};
    tables[0] = make_table<Word, polynomial>();
    for (std::size_t k = 1; k < tables.size(); ++k)
        for (std::size_t octet = 0; octet < 256; ++octet) {
            const Word word = tables[k - 1][octet];
            tables[k][octet] = static_cast<Word>((word << 8) ^ tables[0][word >> (top - 8)]);
        }
    return tables;
}
constexpr auto tables16 = make_tables<std::uint16_t, 0x1021>();
constexpr auto tables32 = make_tables<std::uint32_t, 0x00A00805>();

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> octets, std::uint16_t start) {
    std::uint16_t word = start;
    for (; octets.size() >= 8; octets = octets.subspan(8)) {
        const std::uint8_t* next = octets.data();
        word = static_cast<std::uint16_t>(tables16[7][(word >> 8) ^ next[0]] ^ tables16[6][(word & 0xFF) ^ next[1]] ^
                                          tables16[5][next[2]] ^ tables16[4][next[3]] ^ tables16[3][next[4]] ^
                                          tables16[2][next[5]] ^ tables16[1][next[6]] ^ tables16[0][next[7]]);
    }
    for (const std::uint8_t octet : octets)
        word = static_cast<std::uint16_t>((word << 8) ^ tables16[0][static_cast<std::uint8_t>((word >> 8) ^ octet)]);
    return word;
}

std::uint32_t crc32_proximity(std::span<const std::uint8_t> octets) {
    std::uint32_t word = 0;
    for (; octets.size() >= 8; octets = octets.subspan(8)) {
        const std::uint8_t* next = octets.data();
        word = tables32[7][(word >> 24) ^ next[0]] ^ tables32[6][((word >> 16) & 0xFF) ^ next[1]] ^
               tables32[5][((word >> 8) & 0xFF) ^ next[2]] ^ tables32[4][(word & 0xFF) ^ next[3]] ^
               tables32[3][next[4]] ^ tables32[2][next[5]] ^ tables32[1][next[6]] ^ tables32[0][next[7]];
    }
    for (const std::uint8_t octet : octets) word = (word << 8) ^ tables32[0][(word >> 24) ^ octet];
    return word;
}

}  // namespace aeolis
