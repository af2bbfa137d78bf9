// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/sufr/straighten_up.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_straighten_up_test {

using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

TEST_CASE("bank comes to lift up from either side at 10°/s and stays there", "[gnc][R27]") {
    CHECK(sufr::bank_rad(parameters, 0.0, 0.5) == 0.5);
    CHECK(sufr::bank_rad(parameters, 1.0, 0.5) == Approx(0.5 - parameters.sufr_roll_rate_dps * degree));
    CHECK(sufr::bank_rad(parameters, 1.0, -0.5) == Approx(-0.5 + parameters.sufr_roll_rate_dps * degree));
    CHECK(sufr::bank_rad(parameters, 5.0, -0.5) == Approx(0.0).margin(1e-12));
}

}  // namespace flight_gnc_straighten_up_test
