// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/predicted_doppler.hpp"

#include "server/tones/flown_signal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <cmath>

namespace server_predicted_doppler_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("the predict is the Doppler of the landing without errors, commanded or not, from the scenario's start on",
          "[tones][R31]") {
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    const auto waits_for_commands = test::shipped_scenario("nominal");
    const TimeTable predict_hz = predicted_doppler_hz(waits_for_commands, dictionary.mfsk);
    CHECK(predict_hz.first_s() == Approx(-waits_for_commands.start_before_entry_s));
    const FlownSignal flown =
        fly_signal(simulation::undispersed(test::shipped_scenario("nominal_auto")), 1, 0, dictionary);
    double worst_hz = 0.0;
    for (double e_s = -745.0; e_s < 299.0; e_s += 0.5)  // from X-band's tones on
        worst_hz = std::max(worst_hz, std::abs(predict_hz.at(e_s) - flown.doppler_hz.at(e_s)));
    CHECK(worst_hz < 500.0);  // most where the parachute opens some tenths of a second apart
    CHECK(worst_hz > 1e-6);   // it is not the same flight
    CHECK(std::abs(predict_hz.at(-600.0) - flown.doppler_hz.at(-600.0)) < 30.0);
}

TEST_CASE("the predict of a long cruise has no step where it begins to be flown", "[tones]") {
    auto scenario = test::shipped_scenario("nominal_light_time");
    scenario.start_before_entry_s = 7203.5;  // not a whole number of rows
    const TimeTable predict_hz = predicted_doppler_hz(scenario, tests::shipped_dictionary().mfsk);
    CHECK(predict_hz.first_s() == Approx(-7203.5));
    for (double e_s = -7200.0; e_s < -610.0; e_s += 1.0) {
        INFO(e_s);
        REQUIRE(std::abs(predict_hz.rate_at(e_s + 1.0) - predict_hz.rate_at(e_s)) < 0.5);  // [Hz/s]: cruise is smooth
    }
}

}  // namespace server_predicted_doppler_test
