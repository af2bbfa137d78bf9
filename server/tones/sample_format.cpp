// SPDX-License-Identifier: Apache-2.0
#include "server/tones/sample_format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

/// An unsigned number of `count` octets, the least first.
std::uint64_t number_in(const char* octets, int count, bool is_big_endian) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) {
        const int at = is_big_endian ? i : count - 1 - i;
        value = value << 8U | static_cast<unsigned char>(octets[at]);
    }
    return value;
}

}  // namespace

std::string SampleFormat::name() const {
    const char* letter = kind == Kind::floating ? "f" : kind == Kind::integer ? "i" : "u";
    const char* end = part_octets == 1 ? "" : is_big_endian ? "_be" : "_le";
    return fmt::format("c{}{}{}", letter, 8 * part_octets, end);
}

Result<SampleFormat> sample_format(std::string_view name) {
    using Kind = SampleFormat::Kind;
    constexpr std::array formats{std::pair{"cf32", SampleFormat{Kind::floating, 4, false}},
                                 std::pair{"cf64", SampleFormat{Kind::floating, 8, false}},
                                 std::pair{"ci8", SampleFormat{Kind::integer, 1, false}},
                                 std::pair{"cu8", SampleFormat{Kind::offset, 1, false}},
                                 std::pair{"ci16", SampleFormat{Kind::integer, 2, false}},
                                 std::pair{"cu16", SampleFormat{Kind::offset, 2, false}},
                                 std::pair{"ci32", SampleFormat{Kind::integer, 4, false}},
                                 std::pair{"cu32", SampleFormat{Kind::offset, 4, false}}};
    const bool is_big = name.ends_with("_be");
    const std::string_view plain = is_big || name.ends_with("_le") ? name.substr(0, name.size() - 3) : name;
    for (const auto& [known, format] : formats)
        if (plain == known) {
            SampleFormat found = format;
            found.is_big_endian = is_big && format.part_octets > 1;
            return found;
        }
    if (name.starts_with("r"))
        return Error{fmt::format("'{}' are real samples; the receiver needs complex ones, such as cf32", name)};
    return Error{fmt::format("there is no sample format '{}': cf32, cf64, ci8, cu8, ci16, cu16, ci32 or cu32, "
                             "big-endian with _be",
                             name)};
}

void SampleFormat::decode(std::span<const char> octets, std::span<std::complex<float>> samples) const {
    const char* at = octets.data();
    const auto part = [&] {
        const std::uint64_t raw = number_in(at, part_octets, is_big_endian);
        at += part_octets;
        if (kind == Kind::floating && part_octets == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
        if (kind == Kind::floating) return static_cast<float>(std::bit_cast<double>(raw));
        const std::int64_t middle = std::int64_t{1} << (8 * part_octets - 1);
        const auto value = static_cast<std::int64_t>(raw);
        // Of an even number of steps without a sign the middle is half a step below 2^(n−1).
        if (kind == Kind::offset) return static_cast<float>(static_cast<double>(value - middle) + 0.5);
        return static_cast<float>(value < middle ? value : value - 2 * middle);
    };
    for (auto& sample : samples) {
        const float in_phase = part();
        sample = {in_phase, part()};
    }
}

void SampleFormat::encode(std::span<const std::complex<float>> samples, double scale, std::vector<char>& octets) const {
    const auto put = [&](float value) {
        std::uint64_t raw = 0;
        if (kind == Kind::floating && part_octets == 4) {
            raw = std::bit_cast<std::uint32_t>(value);
        } else if (kind == Kind::floating) {
            raw = std::bit_cast<std::uint64_t>(static_cast<double>(value));
        } else {
            const double middle = std::ldexp(1.0, 8 * part_octets - 1);
            const double scaled = std::clamp(std::round(value * scale), -middle, middle - 1.0);
            raw = static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled + (kind == Kind::offset ? middle : 0.0)));
        }
        for (int i = 0; i < part_octets; ++i) {
            const int place = is_big_endian ? part_octets - 1 - i : i;
            octets.push_back(static_cast<char>(raw >> (8U * static_cast<unsigned>(place)) & 0xffU));
        }
    };
    for (const auto& sample : samples) {
        put(sample.real());
        put(sample.imag());
    }
}

}  // namespace aeolis::server
