// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/dead_reckoning.hpp"

#include "flight/gnc/mars.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_dead_reckoning_test {

using namespace aeolis;
using namespace aeolis::flight;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

/// Flies along y of M, at a height along x.
NavigatedState flying(double speed_mps) {
    NavigatedState state;
    state.p_MoB_M = {3411000.0, 0.0, 0.0};
    state.v_MB_M = {0.0, speed_mps, 0.0};
    return state;
}

Surroundings held(HeldBy by) {
    Surroundings now;
    now.held_by = by;
    now.inertia = {4000.0, 5000.0};
    now.mass_kg = 3000.0;
    now.altitude_m = 20000.0;
    return now;
}

}  // namespace

TEST_CASE("while nothing holds the vehicle a spin goes on, a torque changes it, and no force is felt", "[gnc][R27]") {
    DeadReckoning reckoning;
    Surroundings now = held(HeldBy::nothing);
    const ForceAndRate last{{0.1, 0.2, 0.3}, {0.0, 0.0, 0.2}};
    ForceAndRate felt = reckoning.reckon(parameters, now, flying(5800.0), last, seconds_per_tick);
    CHECK(felt.force_B_mps2.isZero());
    CHECK(felt.rate_B_rps.isApprox(last.rate_B_rps));
    now.torque_B_Nm = {0.0, 0.0, -50.0};
    for (int tick = 0; tick < 64; ++tick)
        felt = reckoning.reckon(parameters, now, flying(5800.0), {}, seconds_per_tick);
    CHECK(felt.rate_B_rps.z() == Approx(0.2 - 50.0 / 5000.0));
    CHECK(reckoning.silent_s() == Approx(65.0 * seconds_per_tick));
    reckoning.end();
    CHECK(reckoning.silent_s() == 0.0);
}

TEST_CASE("in the air the force follows speed and density, and attitude the velocity", "[gnc][R27]") {
    DeadReckoning reckoning;
    Surroundings now = held(HeldBy::air);
    const ForceAndRate last{{0.0, -60.0, 0.0}, {0.05, 0.0, 0.0}};  // B lies along M: drag against y, tumbling about x
    const ForceAndRate first = reckoning.reckon(parameters, now, flying(4000.0), last, seconds_per_tick);
    CHECK(first.force_B_mps2.isApprox(last.force_B_mps2));
    // What turns it across the velocity is the air's to stop: it turns as its velocity does.
    CHECK(std::abs(first.rate_B_rps.x()) < 1e-3);
    now.altitude_m -= parameters.reckoned_scale_height_m * std::log(2.0);
    const ForceAndRate later = reckoning.reckon(parameters, now, flying(2000.0), {}, seconds_per_tick);
    CHECK(later.force_B_mps2.isApprox(0.5 * last.force_B_mps2));  // a quarter by speed, twice by density
    now.free_M_mps2 = {-3.7, 0.0, 0.0};
    const ForceAndRate falling = reckoning.reckon(parameters, now, flying(2000.0), {}, seconds_per_tick);
    CHECK(falling.rate_B_rps.z() - later.rate_B_rps.z() == Approx(3.7 / 2000.0));  // its path bends down, and it too
}

TEST_CASE("a bank reversal under way goes on by its rate and the thrusters' torque", "[gnc][R27]") {
    DeadReckoning reckoning;
    Surroundings now = held(HeldBy::air);
    const ForceAndRate last{{0.0, -60.0, 0.0}, {0.0, 0.3, 0.0}};  // about the velocity
    now.torque_B_Nm = {0.0, -400.0, 0.0};
    ForceAndRate felt;
    for (int tick = 0; tick < 32; ++tick)
        felt = reckoning.reckon(parameters, now, flying(2000.0), last, seconds_per_tick);
    CHECK(felt.rate_B_rps.y() == Approx(0.3 - 0.5 * 400.0 / 4000.0).margin(1e-3));
}

TEST_CASE("under the parachute the force stays where it is and the vehicle swings below it", "[gnc][R27]") {
    DeadReckoning reckoning;
    const Surroundings now = held(HeldBy::parachute);
    NavigatedState state = flying(90.0);
    // The riser pulls against z of B once it hangs straight: here it hangs 0.1 rad aslant.
    const double aslant_rad = 0.1;
    const ForceAndRate last{4.0 * Vector3(std::sin(aslant_rad), 0.0, -std::cos(aslant_rad)), Vector3::Zero()};
    const Vector3 force_M = state.q_MB * last.force_B_mps2;
    double least_rad = aslant_rad;
    for (int tick = 0; tick < 128; ++tick) {
        const ForceAndRate felt = reckoning.reckon(parameters, now, state, last, seconds_per_tick);
        CHECK((state.q_MB * felt.force_B_mps2).isApprox(force_M));
        const Vector3 turned = felt.rate_B_rps * seconds_per_tick;
        state.q_MB = state.q_MB * Quaternion{Eigen::AngleAxisd{turned.norm(), turned.normalized()}};
        const Vector3 pull_B = state.q_MB.conjugate() * force_M;
        least_rad = std::min(least_rad, std::atan2(pull_B.x(), -pull_B.z()));
    }
    CHECK(least_rad < -0.5 * aslant_rad);  // it has swung through, and the bridles have damped it
    CHECK(least_rad > -aslant_rad);
}

TEST_CASE("on engines the force follows their thrust", "[gnc][R27]") {
    DeadReckoning reckoning;
    Surroundings now = held(HeldBy::engines);
    now.thrust_N = 12000.0;
    const ForceAndRate last{{0.0, 0.0, -5.3}, Vector3::Zero()};
    CHECK(reckoning.reckon(parameters, now, flying(30.0), last, seconds_per_tick)
              .force_B_mps2.isApprox(last.force_B_mps2));
    now.thrust_N = 6000.0;
    CHECK(reckoning.reckon(parameters, now, flying(30.0), {}, seconds_per_tick)
              .force_B_mps2.isApprox(0.5 * last.force_B_mps2));
}

TEST_CASE("what is believed widens while the IMU is silent, and with a tilt after that, until the radar narrows it",
          "[gnc][R27]") {
    Belief belief;
    for (int tick = 0; tick < 6400; ++tick) belief.pass(parameters, false, HeldBy::parachute, 4.0, seconds_per_tick);
    CHECK(belief.attitude_rad() == 0.0);  // as long as the IMU speaks nothing does
    CHECK(belief.altitude_m() == 0.0);
    for (int tick = 0; tick < 64; ++tick) belief.pass(parameters, true, HeldBy::parachute, 4.0, seconds_per_tick);
    const double attitude_rad = belief.attitude_rad(), velocity_mps = belief.velocity_mps();
    CHECK(attitude_rad == Approx(parameters.reckoned_rate_parachute_dps * degree));
    CHECK(velocity_mps > parameters.reckoned_force_error * 4.0);
    for (int tick = 0; tick < 64; ++tick) belief.pass(parameters, false, HeldBy::parachute, 4.0, seconds_per_tick);
    CHECK(belief.attitude_rad() == attitude_rad);
    CHECK(belief.velocity_mps() == Approx(velocity_mps + attitude_rad * 4.0));
    CHECK(belief.altitude_m() > 0.0);
    belief.hear_radar(1.0);
    CHECK(belief.velocity_mps() == 0.0);
    for (int i = 0; i < 100; ++i) belief.narrow_attitude(parameters);
    CHECK(belief.attitude_rad() == 0.0);
}

TEST_CASE("increments that come again go on from their own time, not from where reckoning ended", "[gnc][R27]") {
    const Vector3 force_B(1.0, 0.0, 2.0), rate_B(0.0, 0.05, 0.0);
    const auto sample = [&](std::uint32_t count) {
        return ImuSample{count, to_array(Vector3(force_B * imu_period_s)), to_array(Vector3(rate_B * imu_period_s))};
    };
    Strapdown whole, silent;
    for (Strapdown* each : {&whole, &silent}) {
        each->start(flying(100.0));
        for (std::uint32_t count = 1; count <= 100; ++count) each->on(parameters, sample(count), true);
    }
    for (std::uint32_t count = 101; count <= 300; ++count) whole.on(parameters, sample(count), true);
    // 63 ticks are 0.984 s; the first increment that comes again is number 299, so that 198 are missing: 0.99 s.
    for (int tick = 0; tick < 63; ++tick) silent.reckon(force_B, rate_B, seconds_per_tick);
    silent.on(parameters, sample(299), true);
    silent.on(parameters, sample(300), true);
    CHECK((silent.state().p_MoB_M - whole.state().p_MoB_M).norm() < 1e-3);
    CHECK((silent.state().v_MB_M - whole.state().v_MB_M).norm() < 1e-4);
    CHECK(silent.state().q_MB.angularDistance(whole.state().q_MB) < 1e-7);
}

}  // namespace flight_gnc_dead_reckoning_test
