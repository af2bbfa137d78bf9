// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis {

/// Writes bit fields, most significant bit first, into the caller's octets, which must be zero.
class BitWriter {
  public:
    explicit constexpr BitWriter(std::span<std::uint8_t> octets) : octets_(octets) {}

    /// Writes the `bits` (1…64) least significant bits of `value`. Writing past the end is a bug.
    constexpr void put(std::uint64_t value, unsigned bits) {
        AEOLIS_CHECK(bits >= 1 && bits <= 64 && position_ + bits <= octets_.size() * 8);
        while (bits > 0) {
            const unsigned free_bits = 8 - static_cast<unsigned>(position_ % 8);
            const unsigned now = bits < free_bits ? bits : free_bits;
            const auto part = static_cast<unsigned>((value >> (bits - now)) & ((1ULL << now) - 1));
            auto& octet = octets_[position_ / 8];
            octet = static_cast<std::uint8_t>(octet | (part << (free_bits - now)));
            position_ += now;
            bits -= now;
        }
    }
    constexpr void put_signed(std::int64_t value, unsigned bits) { put(static_cast<std::uint64_t>(value), bits); }
    constexpr void put_float(float value) { put(std::bit_cast<std::uint32_t>(value), 32); }
    constexpr void put_octets(std::span<const std::uint8_t> octets) {
        if (position_ % 8 != 0) {
            for (const std::uint8_t octet : octets) put(octet, 8);
            return;
        }
        AEOLIS_CHECK(octets.size() <= octets_.size() - position_ / 8);
        std::ranges::copy(octets, octets_.subspan(position_ / 8).begin());
        position_ += octets.size() * 8;
    }
    constexpr void put_double(double value) { put(std::bit_cast<std::uint64_t>(value), 64); }

    constexpr std::size_t position_bits() const { return position_; }

  private:
    std::span<std::uint8_t> octets_;
    std::size_t position_ = 0;
};

/// Reads the `bits` (1…64) bits at bit `position`, most significant first, zero-extended.
/// The caller checks the range.
constexpr std::uint64_t read_bits(std::span<const std::uint8_t> octets, std::size_t position, unsigned bits) {
    AEOLIS_CHECK(bits >= 1 && bits <= 64 && position + bits <= octets.size() * 8);
    std::uint64_t value = 0;
    while (bits > 0) {
        const unsigned available = 8 - static_cast<unsigned>(position % 8);
        const unsigned now = bits < available ? bits : available;
        const unsigned octet = octets[position / 8];
        value = (value << now) | ((octet >> (available - now)) & ((1U << now) - 1U));
        position += now;
        bits -= now;
    }
    return value;
}

constexpr std::int64_t sign_extend(std::uint64_t value, unsigned bits) {
    const unsigned shift = 64 - bits;
    return static_cast<std::int64_t>(value << shift) >> shift;
}

/// Reads bit fields in sequence, most significant bit first.
class BitReader {
  public:
    explicit constexpr BitReader(std::span<const std::uint8_t> octets) : octets_(octets) {}

    constexpr bool has(std::size_t bits) const { return position_ + bits <= octets_.size() * 8; }
    constexpr std::uint64_t get(unsigned bits) {
        const std::uint64_t value = read_bits(octets_, position_, bits);
        position_ += bits;
        return value;
    }
    constexpr std::int64_t get_signed(unsigned bits) { return sign_extend(get(bits), bits); }
    constexpr float get_float() { return std::bit_cast<float>(static_cast<std::uint32_t>(get(32))); }
    constexpr double get_double() { return std::bit_cast<double>(get(64)); }
    constexpr std::size_t position_bits() const { return position_; }

  private:
    std::span<const std::uint8_t> octets_;
    std::size_t position_ = 0;
};

}  // namespace aeolis
