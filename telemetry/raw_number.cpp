// SPDX-License-Identifier: Apache-2.0
#include "telemetry/raw_number.hpp"

#include "common/bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

namespace aeolis::telemetry {
namespace {

using Coding = dictionary::xtce::Coding;

std::uint64_t octets_reversed(std::uint64_t field, unsigned bits) {
    std::uint64_t result = 0;
    for (unsigned at = 0; at < bits; at += 8) result = (result << 8) | ((field >> at) & 0xFF);
    return result;
}

std::uint64_t bits_reversed(std::uint64_t field, unsigned bits) {
    std::uint64_t result = 0;
    for (unsigned at = 0; at < bits; ++at) result = (result << 1) | ((field >> at) & 1);
    return result;
}

/// A number in IEEE 754 of 16 bits: sign 1, exponent 5, fraction 10.
double half_of(std::uint64_t field) {
    const auto exponent = static_cast<int>((field >> 10) & 0x1F);
    const auto fraction = static_cast<double>(field & 0x3FF);
    const double sign = (field & 0x8000) != 0 ? -1.0 : 1.0;
    if (exponent == 0x1F) return fraction == 0.0 ? sign * INFINITY : NAN;
    return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(fraction + 1024.0, exponent - 25));
}

double real_of(std::uint64_t field, unsigned bits) {
    if (bits == 64) return std::bit_cast<double>(field);
    if (bits == 32) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(field)));
    return half_of(field);
}

double mil1750a_of(std::uint64_t field) {
    const auto mantissa = static_cast<double>(sign_extend(field >> 8, 24));
    return std::ldexp(mantissa, static_cast<int>(sign_extend(field & 0xFF, 8)) - 23);
}

RawNumber bcd_of(std::uint64_t field, unsigned bits, unsigned digit_bits) {
    std::uint64_t value = 0;
    for (unsigned at = (bits + digit_bits - 1) / digit_bits; at > 0; --at) {
        const auto digit = (field >> (digit_bits * (at - 1))) & ((1U << digit_bits) - 1);
        if (digit > 9) return NAN;
        value = value * 10 + digit;
    }
    return value;
}

std::optional<double> finite_or_none(double value) {
    return std::isfinite(value) ? std::optional{value} : std::nullopt;
}

std::int64_t negative(std::uint64_t magnitude) {
    return -static_cast<std::int64_t>(magnitude);
}

}  // namespace

RawNumber number_in(std::uint64_t field, unsigned bits, const Coding& coding) {
    const bool octets = bits % 8 == 0;
    // The order of bits is that within octets, the order of octets that among them; both least significant first are a
    // field with its least significant bit first. A field of parts of octets has an order of bits alone.
    if (coding.least_significant_octet_first && octets) field = octets_reversed(field, bits);
    if (coding.least_significant_bit_first) field = bits_reversed(field, bits);
    if (coding.least_significant_bit_first && octets) field = octets_reversed(field, bits);
    const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
    const std::uint64_t all = sign | (sign - 1);
    const bool below_zero = (field & sign) != 0;
    switch (coding.form) {
    case Coding::Form::twos_complement: return sign_extend(field, bits);
    case Coding::Form::ones_complement: return below_zero ? negative(~field & all) : static_cast<std::int64_t>(field);
    case Coding::Form::sign_and_magnitude:
        return below_zero ? negative(field & ~sign) : static_cast<std::int64_t>(field);
    case Coding::Form::bcd: return bcd_of(field, bits, 4);
    case Coding::Form::bcd_octets: return bcd_of(field, bits, 8);
    case Coding::Form::ieee754: return real_of(field, bits);
    case Coding::Form::mil1750a: return mil1750a_of(field);
    case Coding::Form::unsigned_integer:
    case Coding::Form::text:
    case Coding::Form::octets: break;
    }
    return field;
}

std::optional<double> calibrated_by(const dictionary::xtce::Calibration& calibration, double raw) {
    if (!calibration.known) return std::nullopt;
    if (!calibration.polynomial.empty()) {
        double sum = 0.0;
        for (auto term = calibration.polynomial.rbegin(); term != calibration.polynomial.rend(); ++term)
            sum = sum * raw + *term;
        return finite_or_none(sum);
    }
    const auto& points = calibration.spline;
    auto above = std::ranges::upper_bound(points, raw, {}, [](const auto& point) { return point.first; });
    const bool outside = above == points.begin() || (above == points.end() && raw != points.back().first);
    if (outside && !calibration.extrapolate) return std::nullopt;
    if (calibration.flat || points.size() == 1)
        return finite_or_none(above == points.begin() ? above->second : std::prev(above)->second);
    // The closest outside point and the interpolation beside it extend outside. [xtce-1.2]
    if (above == points.begin()) ++above;
    if (above == points.end()) --above;
    const auto below = std::prev(above);
    if (raw == above->first) return finite_or_none(above->second);
    const double part = (raw - below->first) / (above->first - below->first);
    return finite_or_none(below->second + part * (above->second - below->second));
}

}  // namespace aeolis::telemetry
