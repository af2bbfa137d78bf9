// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/characters.hpp"

#include <array>

namespace aeolis::dictionary::xtce {
namespace {

using Characters = Coding::Characters;
using Octets = std::span<const std::uint8_t>;

constexpr char32_t first_surrogate = 0xD800, first_low_surrogate = 0xDC00, last_surrogate = 0xDFFF;
constexpr char32_t last_code_point = 0x10FFFF, beyond_one_unit = 0x10000, order_mark = 0xFEFF, swapped_mark = 0xFFFE;

bool is_character(char32_t code) {
    return code <= last_code_point && (code < first_surrogate || code > last_surrogate);
}

void append(std::string& text, char32_t code) {
    const auto octet = [&](char32_t bits) { text.push_back(static_cast<char>(static_cast<unsigned char>(bits))); };
    if (code < 0x80) return octet(code);
    if (code < 0x800) {
        octet(0xC0 | code >> 6U);
    } else {
        if (code < beyond_one_unit) {
            octet(0xE0 | code >> 12U);
        } else {
            octet(0xF0 | code >> 18U);
            octet(0x80 | ((code >> 12U) & 0x3FU));
        }
        octet(0x80 | ((code >> 6U) & 0x3FU));
    }
    octet(0x80 | (code & 0x3FU));
}

/// The number of octets of the character that begins here, if they are a right one in UTF-8; else 0.
std::size_t utf8_character(Octets octets) {
    constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
    const std::uint8_t lead = octets[0];
    if (lead < 0x80) return 1;
    const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || octets.size() < size) return 0;
    char32_t code = lead & (0x7FU >> size);
    for (const std::uint8_t next : octets.subspan(1, size - 1)) {
        if ((next & 0xC0U) != 0x80) return 0;
        code = code << 6U | (next & 0x3FU);
    }
    return is_character(code) && code >= least.at(size) ? size : 0;
}

std::optional<std::string> from_utf8(Octets octets) {
    for (std::size_t at = 0; at < octets.size();) {
        if (octets[at] < 0x80) {  // most are
            ++at;
            continue;
        }
        const auto size = utf8_character(octets.subspan(at));
        if (size == 0) return std::nullopt;
        at += size;
    }
    return std::string{octets.begin(), octets.end()};
}

std::optional<std::string> from_utf16(Octets octets, bool little_endian) {
    if (octets.size() % 2 != 0) return std::nullopt;
    const auto unit = [&](std::size_t at) {
        return static_cast<char32_t>(little_endian ? octets[at] | octets[at + 1] << 8
                                                   : octets[at] << 8 | octets[at + 1]);
    };
    std::size_t at = 0;
    if (octets.size() >= 2 && unit(0) == swapped_mark) little_endian = !little_endian;
    if (octets.size() >= 2 && unit(0) == order_mark) at = 2;
    std::size_t end = octets.size();
    while (end > at && unit(end - 2) == 0) end -= 2;
    std::string text;
    for (; at < end; at += 2) {
        char32_t code = unit(at);
        if (code >= first_surrogate && code < first_low_surrogate && at + 2 < end) {
            const char32_t low = unit(at + 2);
            if (low < first_low_surrogate || low > last_surrogate) return std::nullopt;
            code = beyond_one_unit + ((code - first_surrogate) << 10U) + (low - first_low_surrogate);
            at += 2;
        }
        if (!is_character(code)) return std::nullopt;
        append(text, code);
    }
    return text;
}

}  // namespace

std::optional<std::string> text_of(Octets octets, Characters characters) {
    if (characters == Characters::utf16_big_endian || characters == Characters::utf16_little_endian)
        return from_utf16(octets, characters == Characters::utf16_little_endian);
    while (!octets.empty() && octets.back() == 0) octets = octets.first(octets.size() - 1);
    if (characters == Characters::utf8) return from_utf8(octets);
    std::string text;
    for (const std::uint8_t octet : octets) append(text, octet);
    return text;
}

}  // namespace aeolis::dictionary::xtce
