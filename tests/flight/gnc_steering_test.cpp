// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/steering.hpp"

#include "flight/gnc/attitude/attitude_control.hpp"
#include "tests/support/catch.hpp"

#include <array>

namespace flight_gnc_steering_test {

using namespace aeolis;
using namespace aeolis::flight;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

constexpr double full_N = 3000.0;
constexpr Inertia inertia{4000.0, 5000.0};

/// It spins about x, and shall not.
struct Spinning {
    AttitudeCommand wanted{.mode = AttitudeCommand::Mode::detumble};
    AttitudeState state{.rate_B_rps = {0.1, 0.0, 0.0}};
    ThrusterCommand thrusters;
    std::array<double, 8> throttle{0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    EngineCommand engines{.throttle = throttle};

    /// Until thrusters have been owed enough for a pulse.
    void steer(Steers by) {
        Steering steering{full_N};
        for (int cycle = 0; cycle < 64 && thrusters == ThrusterCommand{}; ++cycle) {
            engines.throttle = throttle;
            steering.cycle(parameters, wanted, state, inertia, by, thrusters, engines);
        }
    }
};

}  // namespace

TEST_CASE("what steers takes the spin out and what does not steer is left alone", "[gnc][R27]") {
    const Spinning untouched;

    Spinning by_thrusters;
    by_thrusters.steer(Steers::thrusters);
    CHECK(by_thrusters.thrusters != untouched.thrusters);
    CHECK(by_thrusters.engines.throttle == untouched.engines.throttle);

    Spinning by_engines;
    by_engines.steer(Steers::eight_engines);
    CHECK(by_engines.thrusters == untouched.thrusters);
    CHECK(by_engines.engines.throttle != untouched.engines.throttle);
}

TEST_CASE("four engines steer with the four that are lit", "[gnc][R27]") {
    Spinning by_engines;
    by_engines.throttle = {0.5, 0.0, 0.5, 0.0, 0.5, 0.0, 0.5, 0.0};
    by_engines.steer(Steers::four_engines);
    for (const std::size_t off : {1, 3, 5, 7}) CHECK(by_engines.engines.throttle[off] == 0.0);
    CHECK(by_engines.engines.throttle[0] + by_engines.engines.throttle[2] + by_engines.engines.throttle[4] +
              by_engines.engines.throttle[6] ==
          Approx(2.0));
    CHECK(by_engines.engines.throttle[0] != by_engines.engines.throttle[4]);
}

}  // namespace flight_gnc_steering_test
