// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::telemetry {

/// A Reed–Solomon code of telemetry: of 255 symbols of 8 bits, 32 or 16 are check symbols, of which half can be
/// corrected.
///
/// A codeblock holds `interleave` code words: octet k belongs to word k mod interleave, and the check symbols of all
/// stand at the end. Words of fewer than 255 symbols are shortened: the zeros in front are not sent. [ccsds-131.0-b-5]
struct ReedSolomonCode {
    enum class Basis : std::uint8_t { dual, conventional };
    static constexpr std::size_t word_symbols_max = 255;

    std::size_t check_symbols = 32;  ///< of a word: 32 for (255,223), 16 for (255,239)
    std::size_t interleave = 1;      ///< 1, 2, 3, 4, 5 or 8
    Basis basis = Basis::dual;       ///< in which symbols are sent; the standard's is the dual one

    constexpr std::size_t check_octets() const { return check_symbols * interleave; }
    constexpr std::size_t data_octets_max() const { return (word_symbols_max - check_symbols) * interleave; }
    /// Whether codeblocks of this length, check symbols included, can be of this code.
    constexpr bool fits(std::size_t codeblock_octets) const {
        return codeblock_octets > check_octets() && codeblock_octets % interleave == 0 &&
               codeblock_octets / interleave <= word_symbols_max;
    }
    bool operator==(const ReedSolomonCode&) const = default;
};

/// What was found in a codeblock.
struct Correction {
    std::size_t symbols = 0;              ///< corrected
    std::size_t uncorrectable_words = 0;  ///< left as they were
};

/// Corrects a codeblock in place. A word with more wrong symbols than can be corrected is left as it is. The chance
/// that it is taken for another word is 1 in 16! with 32 check symbols, and 1 in 8! (40 320) with 16.
///
/// Rate     above 20 MB/s without errors, above 5 MB/s with as many as can be corrected (bench/reed_solomon_bench.cpp)
/// @param codeblock  data and check symbols, of a length that `code` fits
Correction correct_codeblock(const ReedSolomonCode& code, std::span<std::uint8_t> codeblock);

}  // namespace aeolis::telemetry
