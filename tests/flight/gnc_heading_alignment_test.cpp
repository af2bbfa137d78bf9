// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/heading_alignment.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_heading_alignment_test {

using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

TEST_CASE("bank is a hundred times the angle to the target, towards it", "[gnc][R27]") {
    CHECK(heading_alignment_bank_rad(parameters, {80000.0, 80.0, 80000.0}) == Approx(0.1).epsilon(1e-5));
    CHECK(heading_alignment_bank_rad(parameters, {80000.0, -80.0, 80000.0}) == Approx(-0.1).epsilon(1e-5));
}

TEST_CASE("bank stays within 30°, also with the target behind", "[gnc][R27]") {
    CHECK(heading_alignment_bank_rad(parameters, {80000.0, 5000.0, 80000.0}) == Approx(30.0 * degree));
    CHECK(heading_alignment_bank_rad(parameters, {80000.0, -5000.0, -100.0}) == Approx(-30.0 * degree));
}

}  // namespace flight_gnc_heading_alignment_test
