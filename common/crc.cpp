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

constexpr auto table16 = make_table<std::uint16_t, 0x1021>();
constexpr auto table32 = make_table<std::uint32_t, 0x00A00805>();

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> octets) {
    std::uint16_t word = 0xFFFF;
    for (const std::uint8_t octet : octets)
        word = static_cast<std::uint16_t>((word << 8) ^ table16[static_cast<std::uint8_t>((word >> 8) ^ octet)]);
    return word;
}

std::uint32_t crc32_proximity(std::span<const std::uint8_t> octets) {
    std::uint32_t word = 0;
    for (const std::uint8_t octet : octets) word = (word << 8) ^ table32[static_cast<std::uint8_t>((word >> 24) ^ octet)];
    return word;
}

}  // namespace aeolis
