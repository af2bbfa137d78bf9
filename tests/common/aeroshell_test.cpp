// SPDX-License-Identifier: Apache-2.0
#include "common/aeroshell.hpp"

#include "tests/support/catch.hpp"

#include <numbers>

namespace common_aeroshell_test {

using namespace aeolis;

namespace {

constexpr double degree_rad = std::numbers::pi / 180.0;

}  // namespace

TEST_CASE("the aeroshell's coefficients are the table's where the table stands", "[simulation][aeroshell]") {
    CHECK(aeroshell_coefficients(24.5, 16.0 * degree_rad).drag == Approx(1.4612));
    CHECK(aeroshell_coefficients(24.5, 16.0 * degree_rad).lift == Approx(1.04 * 0.3621));
    CHECK(aeroshell_coefficients(2.0, 0.0).lift == 0.0);
    CHECK(aeroshell_coefficients(100.0, 0.0).drag == Approx(1.7026));
}

}  // namespace common_aeroshell_test
