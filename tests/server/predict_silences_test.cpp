// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/predict_silences.hpp"

#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace server_predict_silences_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE(
    "blackout, antenna hand-over and Earth set are predicted before the landing flies, near those of the published one",
    "[station][silence]") {
    const auto predicted = predict_silences(test::shipped_scenario("nominal_auto"), tests::shipped_dictionary());
    REQUIRE(predicted.blackout);
    CHECK(predicted.blackout->from_s == Approx(45.0).margin(3.0));
    CHECK(predicted.blackout->to_s == Approx(98.5).margin(5.0));
    REQUIRE(predicted.hand_over_s);
    CHECK(*predicted.hand_over_s == Approx(256.15));  // 0.25 s after the mortar, which the design has at E+255.9 s
    REQUIRE(predicted.earth_set_s);
    CHECK(*predicted.earth_set_s == Approx(297.0).margin(15.0));  // as OD137 saw it
    REQUIRE(predicted.uhf_stop_s);
    CHECK(*predicted.uhf_stop_s > 431.0);
    CHECK_FALSE(predicted.carrier_weak);
}

TEST_CASE("what the scenario says of Earth set and of the link's budget is what ground predicts",
          "[station][silence]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.earth_set_after_entry_s = 120.0;
    scenario.radio.x_band_c_n0_dbhz = 15.0;
    const auto predicted = predict_silences(scenario, tests::shipped_dictionary());
    CHECK(predicted.earth_set_s == 120.0);
    CHECK(predicted.carrier_weak);
}

}  // namespace server_predict_silences_test
