// SPDX-License-Identifier: Apache-2.0
#include "common/aos_header.hpp"

#include <algorithm>
#include <cstddef>

namespace aeolis {
namespace {

/// GF(16), by logarithms.
struct HeaderField {
    static constexpr unsigned order = 15;  ///< of its multiplicative group
    std::array<unsigned, order> power{};   ///< of α
    std::array<unsigned, order + 1> log{};

    constexpr HeaderField() {
        unsigned value = 1;
        for (unsigned i = 0; i < order; ++i) {
            power.at(i) = value;
            log.at(value) = i;
            value <<= 1;
            if ((value & 0x10) != 0) value ^= 0b10011;
        }
    }
    constexpr unsigned times(unsigned a, unsigned exponent) const {
        return a == 0 ? 0 : power.at((log.at(a) + exponent) % order);
    }
    constexpr unsigned over(unsigned a, unsigned b) const { return times(a, order - log.at(b)); }
};
constexpr HeaderField gf16;

constexpr unsigned header_symbols = 10, header_check_symbols = 4, first_header_root = 6;
// Of two symbols each: identifiers, signalling field, error control.
constexpr std::array<std::size_t, 5> protected_octets{0, 1, 5, 6, 7};

/// Symbol of an exponent, 9 … 0 from the first on.
unsigned header_symbol(const AosHeader& header, unsigned exponent) {
    const unsigned place = header_symbols - 1 - exponent;
    return unsigned{header.at(protected_octets.at(place / 2))} >> (place % 2 == 0 ? 4U : 0U) & 0xFU;
}

void add_to_symbol(AosHeader& header, unsigned exponent, unsigned error) {
    const unsigned place = header_symbols - 1 - exponent;
    header.at(protected_octets.at(place / 2)) ^= static_cast<std::uint8_t>(error << (place % 2 == 0 ? 4U : 0U));
}

using HeaderSyndromes = std::array<unsigned, header_check_symbols>;

HeaderSyndromes header_syndromes(const AosHeader& header) {
    HeaderSyndromes sums{};
    for (unsigned exponent = 0; exponent < header_symbols; ++exponent)
        for (unsigned i = 0; i < header_check_symbols; ++i)
            sums.at(i) ^= gf16.times(header_symbol(header, exponent), (first_header_root + i) * exponent);
    return sums;
}

bool all_zero(const HeaderSyndromes& sums) {
    return std::ranges::all_of(sums, [](unsigned sum) { return sum == 0; });
}

}  // namespace

std::optional<unsigned> correct_aos_header(AosHeader& header) {
    const HeaderSyndromes sums = header_syndromes(header);
    if (all_zero(sums)) return 0;
    // Errors at exponents i and k: of the first root X = e_i α^(6i) and Y = e_k α^(6k), with X + Y and X α^i + Y α^k.
    for (unsigned i = 0; i < header_symbols; ++i)
        for (unsigned k = i; k < header_symbols; ++k) {
            AosHeader tried = header;
            unsigned wrong = 1;
            if (i == k) {
                add_to_symbol(tried, i,
                              gf16.times(sums[0], HeaderField::order * first_header_root - first_header_root * i));
            } else {
                const unsigned x = gf16.over(sums[1] ^ gf16.times(sums[0], k), gf16.power.at(i) ^ gf16.power.at(k));
                wrong = x == 0 || x == sums[0] ? 1 : 2;
                add_to_symbol(tried, i, gf16.times(x, HeaderField::order * first_header_root - first_header_root * i));
                add_to_symbol(tried, k,
                              gf16.times(sums[0] ^ x, HeaderField::order * first_header_root - first_header_root * k));
            }
            if (!all_zero(header_syndromes(tried))) continue;
            header = tried;
            return wrong;
        }
    return std::nullopt;
}

}  // namespace aeolis
