// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// The layout of complex samples in octets: in-phase then quadrature, by the names of SigMF. Source: [sigmf].
struct SampleFormat {
    enum class Kind { floating, integer, offset };  ///< offset: without a sign, the middle is zero
    Kind kind = Kind::floating;
    int part_octets = 4;
    bool is_big_endian = false;

    static const SampleFormat cf32, ci16, ci8;
    bool operator==(const SampleFormat&) const = default;

    std::size_t octets_a_sample() const { return 2 * static_cast<std::size_t>(part_octets); }
    /// The name in SigMF: cf32_le, ci16_be, ci8. SigMF has no name for three octets; here it is ci24_le.
    std::string name() const;

    /// Reads whole samples. `octets`: as many as `samples` need.
    void decode(std::span<const char> octets, std::span<std::complex<float>> samples) const;
    /// Appends samples; integers are scaled, and end at their range.
    void encode(std::span<const std::complex<float>> samples, double scale, std::vector<char>& octets) const;
};
inline constexpr SampleFormat SampleFormat::cf32{Kind::floating, 4, false};
inline constexpr SampleFormat SampleFormat::ci16{Kind::integer, 2, false};
inline constexpr SampleFormat SampleFormat::ci8{Kind::integer, 1, false};

/// Reads a name: cf32, cf64, ci8, cu8, ci16, cu16, ci32, cu32, with _le or _be; without, little-endian.
Result<SampleFormat> sample_format(std::string_view name);

}  // namespace aeolis::server
