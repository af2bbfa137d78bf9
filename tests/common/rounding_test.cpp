// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"

#include <array>

namespace common_rounding_test {

namespace {

/// The form that g++ 12.2 -O2 gets wrong where it makes vectors of neighbouring values.
[[gnu::noinline]] std::array<double, 2> as_recorded(double first, double second) {
    std::array<double, 2> rounded{};
    const std::array<double, 2> exact{first, second};
    for (std::size_t i = 0; i < exact.size(); ++i) rounded[i] = static_cast<double>(static_cast<float>(exact[i]));
    return rounded;
}

}  // namespace

TEST_CASE("what goes through a float is rounded, in every build and also in pairs", "[toolchain]") {
    volatile double one = 0.1, other = 0.3;
    const auto pair = as_recorded(one, other);
    CHECK(pair[0] == 0.100000001490116119384765625);
    CHECK(pair[1] == 0.300000011920928955078125);
}

}  // namespace common_rounding_test
