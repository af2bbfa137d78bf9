// SPDX-License-Identifier: Apache-2.0
// Reed–Solomon codeblocks by plain division of polynomials, from the standard's text alone: it shares nothing with the
// decoder but the code's parameters. [ccsds-131.0-b-5]
#pragma once

#include "telemetry/reed_solomon.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::test {

/// Product of two elements of GF(2^8), bit by bit, modulo x^8 + x^7 + x^2 + x + 1.
inline std::uint8_t product(unsigned a, unsigned b) {
    unsigned sum = 0;
    for (int bit = 7; bit >= 0; --bit) {
        sum <<= 1U;
        if ((sum & 0x100U) != 0) sum ^= 0x187U;
        if ((b >> static_cast<unsigned>(bit) & 1U) != 0) sum ^= a;
    }
    return static_cast<std::uint8_t>(sum);
}

/// alpha to the power `exponent`; alpha is x.
inline std::uint8_t alpha_to(unsigned exponent) {
    std::uint8_t value = 1;
    for (unsigned i = 0; i < exponent % 255; ++i) value = product(value, 2);
    return value;
}

/// The code's generator, from the highest power down.
inline std::vector<std::uint8_t> generator_of(std::size_t check_symbols) {
    std::vector<std::uint8_t> generator{1};
    for (unsigned j = 128 - static_cast<unsigned>(check_symbols) / 2; generator.size() <= check_symbols; ++j) {
        generator.push_back(0);
        for (std::size_t i = generator.size() - 1; i > 0; --i)
            generator[i] = static_cast<std::uint8_t>(generator[i] ^ product(alpha_to(11 * j), generator[i - 1]));
    }
    return generator;
}

/// A symbol in the dual basis, by the standard's matrix: its rows for alpha^7 … alpha^0.
inline std::uint8_t to_dual(std::uint8_t symbol) {
    constexpr std::array<std::uint8_t, 8> matrix{0x8D, 0xEF, 0xEC, 0x86, 0xFA, 0x99, 0xAF, 0x7B};
    unsigned sum = 0;
    for (unsigned bit = 0; bit < 8; ++bit)
        if ((symbol >> (7U - bit) & 1U) != 0) sum ^= matrix.at(bit);
    return static_cast<std::uint8_t>(sum);
}
inline std::uint8_t from_dual(std::uint8_t sent) {
    static const auto table = [] {
        std::array<std::uint8_t, 256> symbols{};
        for (unsigned i = 0; i < 256; ++i)
            symbols.at(to_dual(static_cast<std::uint8_t>(i))) = static_cast<std::uint8_t>(i);
        return symbols;
    }();
    return table.at(sent);
}

/// `data` and behind it the check symbols.
inline std::vector<std::uint8_t> codeblock_of(std::span<const std::uint8_t> data,
                                              const telemetry::ReedSolomonCode& code) {
    const bool dual = code.basis == telemetry::ReedSolomonCode::Basis::dual;
    const auto generator = generator_of(code.check_symbols);
    std::vector<std::array<std::uint8_t, 256>> multiples(generator.size());
    for (std::size_t i = 0; i < generator.size(); ++i)
        for (unsigned symbol = 0; symbol < 256; ++symbol) multiples[i].at(symbol) = product(generator[i], symbol);
    std::vector<std::uint8_t> block{data.begin(), data.end()};
    block.resize(data.size() + code.check_octets());
    for (std::size_t first = 0; first < code.interleave; ++first) {
        std::vector<std::uint8_t> word;
        for (std::size_t i = first; i < data.size(); i += code.interleave)
            word.push_back(dual ? from_dual(data[i]) : data[i]);
        const std::size_t size = word.size();
        word.resize(size + code.check_symbols);
        for (std::size_t i = 0; i < size; ++i) {
            const auto quotient = word[i];
            for (std::size_t k = 0; k < generator.size(); ++k) word[i + k] ^= multiples[k].at(quotient);
        }
        for (std::size_t k = 0; k < code.check_symbols; ++k)
            block[data.size() + first + k * code.interleave] = dual ? to_dual(word[size + k]) : word[size + k];
    }
    return block;
}

}  // namespace aeolis::test
