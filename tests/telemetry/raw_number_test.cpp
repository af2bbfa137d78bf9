// SPDX-License-Identifier: Apache-2.0
#include "telemetry/raw_number.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace telemetry_raw_number_test {

using namespace aeolis::telemetry;
using aeolis::dictionary::xtce::Coding;
using Form = Coding::Form;

namespace {

template <typename T>
T number(std::uint64_t field, unsigned bits, Form form, bool octets_reversed = false, bool bits_reversed = false) {
    Coding coding;
    coding.form = form;
    coding.least_significant_octet_first = octets_reversed;
    coding.least_significant_bit_first = bits_reversed;
    const auto value = number_in(field, bits, coding);
    REQUIRE(std::holds_alternative<T>(value));
    return std::get<T>(value);
}

}  // namespace

TEST_CASE("whole numbers in every coding", "[telemetry]") {
    CHECK(number<std::uint64_t>(~0ULL, 64, Form::unsigned_integer) == ~0ULL);
    CHECK(number<std::int64_t>(0x1, 1, Form::twos_complement) == -1);
    CHECK(number<std::int64_t>(0xFFE, 12, Form::twos_complement) == -2);
    CHECK(number<std::int64_t>(1ULL << 63, 64, Form::twos_complement) == INT64_MIN);
    CHECK(number<std::int64_t>(0xFE, 8, Form::ones_complement) == -1);
    CHECK(number<std::int64_t>(0x7F, 8, Form::ones_complement) == 127);
    CHECK(number<std::int64_t>(0x85, 8, Form::sign_and_magnitude) == -5);
    CHECK(number<std::int64_t>(0x05, 8, Form::sign_and_magnitude) == 5);
    CHECK(number<std::uint64_t>(0x1234, 16, Form::bcd) == 1234);
}

TEST_CASE("octets and bits in the other order", "[telemetry]") {
    CHECK(number<std::uint64_t>(0x3412, 16, Form::unsigned_integer, true) == 0x1234);
    CHECK(number<std::uint64_t>(0x563412, 24, Form::unsigned_integer, true) == 0x123456);
    CHECK(number<std::int64_t>(0xFEFF, 16, Form::twos_complement, true) == -2);
    CHECK(number<std::uint64_t>(0b10110, 5, Form::unsigned_integer, false, true) == 0b01101);
    CHECK(number<double>(0x0000803F, 32, Form::ieee754, true) == 1.0);
}

TEST_CASE("real numbers of 16, 32 and 64 bits, and of MIL-STD-1750A", "[telemetry]") {
    CHECK(number<double>(0x3C00, 16, Form::ieee754) == 1.0);
    CHECK(number<double>(0xC500, 16, Form::ieee754) == -5.0);
    CHECK(number<double>(0x0001, 16, Form::ieee754) == std::ldexp(1.0, -24));
    CHECK(std::isinf(number<double>(0x7C00, 16, Form::ieee754)));
    CHECK(number<double>(0x40490FDB, 32, Form::ieee754) == Approx(3.14159274));
    CHECK(number<double>(0x400921FB54442D18, 64, Form::ieee754) == 3.141592653589793);
    // The standard's own examples: 0.5 × 2^127, 0.5 × 2^0, −1 × 2^0, 0.75 × 2^-1.
    CHECK(number<double>(0x4000007F, 32, Form::mil1750a) == std::ldexp(0.5, 127));
    CHECK(number<double>(0x40000000, 32, Form::mil1750a) == 0.5);
    CHECK(number<double>(0x80000000, 32, Form::mil1750a) == -1.0);
    CHECK(number<double>(0x600000FF, 32, Form::mil1750a) == 0.375);
}

}  // namespace telemetry_raw_number_test
