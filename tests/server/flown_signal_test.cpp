// SPDX-License-Identifier: Apache-2.0
#include "server/tones/flown_signal.hpp"

#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace server_flown_signal_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("on the published landing Earth sets when it did, and the antennas lose little until then", "[tones][R31]") {
    const FlownSignal flown = fly_signal(test::shipped_scenario("od137"), 1, 0, tests::shipped_dictionary());
    CHECK(flown.earth_set_s == Approx(299.0).margin(3.0));  // [facts]
    REQUIRE(flown.outages.size() == 2);                     // those that the scenario lists
    CHECK(flown.outages[0].name == "line stretch");
    CHECK(flown.outages[0].from_s == Approx(257.0 + 1.12 - 10.0).margin(3.0));
    CHECK(flown.outages[0].to_s == Approx(257.0 + 1.12 + 10.0).margin(3.0));
    CHECK(flown.outages[1].name == "Earth set");
    CHECK(flown.outages[1].from_s == flown.earth_set_s);
    CHECK(flown.tones.size() > 30);
    CHECK(flown.tones.back().start_s < flown.earth_set_s);
    double least_db = 0.0;
    for (double e_s = -890.0; e_s < flown.earth_set_s; e_s += 0.25)
        least_db = std::min(least_db, flown.gain_db.at(e_s));
    CHECK(least_db > -3.5);
    CHECK(least_db < -0.5);                  // attitude does count
    CHECK(flown.gain_db.at(-700.0) > -0.1);  // a spinning spacecraft points its antenna at Earth
}

}  // namespace server_flown_signal_test
