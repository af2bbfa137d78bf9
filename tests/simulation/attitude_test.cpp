// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/rigid_body.hpp"
#include "simulation/vehicle/thrusters.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

#include "common/time.hpp"
#include "flight/devices/effectors.hpp"

#include <algorithm>
#include <cmath>

namespace simulation_attitude_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

RigidBody tumbling() {
    RigidBody body;
    body.p_MoB_M = {5.0e6, 0.0, 1.0e6};
    body.v_MB_M = {-3000.0, 3500.0, 200.0};
    body.rate_B_rps = {0.3, -0.2, 0.5};
    return body;
}

const Inertia uneven{{4000.0, 4300.0, 5000.0}};

RigidBody flown(RigidBody body, double for_s, double step_s, const Inertia& inertia = uneven) {
    const auto nothing = [](double, const RigidBody&) { return Wrench{}; };
    const auto steps = static_cast<int>(std::lround(for_s / step_s));
    for (int i = 0; i < steps; ++i) body = runge_kutta_step(body, step_s, 3000.0, inertia, nothing);
    return body;
}

/// Angular momentum in axes that do not turn with Mars.
Vector3 momentum(const RigidBody& body, double time_s) {
    const Quaternion mars = rotation({0.0, 0.0, mars_spin_rps * time_s});
    return mars * body.q_MB * uneven.moments_B.cwiseProduct(body.rate_B_rps);
}
double energy(const RigidBody& body) {
    return 0.5 * body.rate_B_rps.dot(uneven.moments_B.cwiseProduct(body.rate_B_rps));
}

}  // namespace

TEST_CASE("a body that nothing turns keeps its angular momentum in inertial space, and its energy of rotation",
          "[simulation][attitude]") {
    const RigidBody start = tumbling();
    const RigidBody end = flown(start, 600.0, 0.005);
    CHECK((momentum(end, 600.0) - momentum(start, 0.0)).norm() / momentum(start, 0.0).norm() < 1.0e-9);
    CHECK(energy(end) == Approx(energy(start)).epsilon(1.0e-9));
    CHECK(end.q_MB.norm() == Approx(1.0));
}

TEST_CASE("halving the step makes the error of rotation sixteen times smaller: fourth order",
          "[simulation][attitude]") {
    const RigidBody start = tumbling();
    const Quaternion best = flown(start, 20.0, 0.0025).q_MB;
    const auto error = [&](double step_s) { return flown(start, 20.0, step_s).q_MB.angularDistance(best); };
    const double order = std::log2(error(0.16) / error(0.08));
    CHECK(order > 3.7);
    CHECK(order < 4.5);
}

TEST_CASE("a thruster's pulse gives its whole impulse, wherever the steps fall", "[simulation][attitude]") {
    for (const double on_s : {0.004, 0.0077, seconds_per_tick}) {
        Thrusters thrusters;
        flight::ThrusterCommand command;
        command.on_s[2] = on_s;
        thrusters.command(command, true, 10.0);
        double impulse_Ns = 0.0;
        Vector3 twist_Nms = Vector3::Zero();
        for (int step = 0; step < 10; ++step) {
            if (step == 4) thrusters.command({}, true, 10.0 + seconds_per_tick);  // does not cut off what still burns
            const auto push = thrusters.mean(10.0 + 0.00390625 * step, 0.00390625);
            impulse_Ns += push.force_B.norm() * 0.00390625;
            twist_Nms += push.torque_B * 0.00390625;
        }
        CHECK(impulse_Ns == Approx(302.0 * on_s));
        const auto mounted = flight::entry_thrusters()[2];
        CHECK((twist_Nms - vector3(mounted.position_B_m).cross(302.0 * on_s * vector3(mounted.direction_B))).norm() <
              1e-9);
    }
    Thrusters off;
    flight::ThrusterCommand command;
    command.on_s.fill(0.01);
    off.command(command, false, 10.0);
    CHECK(off.mean(10.0, 0.01).force_B.isZero());
}

TEST_CASE("a bank reversal is flown within 20 degrees a second, in the time that the published flight took",
          "[simulation][attitude][R27]") {
    tests::TruthPilot pilot{tests::undisturbed_scenario(620.0)};
    pilot.run_until(98.0);  // where the stand-in asks for it
    double fastest_dps = 0.0, taken_s = 0.0, before = pilot.world.inspect().bank_deg;
    CHECK(before == Approx(-48.0).margin(3.0));
    while (pilot.world.truth().e_s < 118.0) {
        for (int tick = 0; tick < 16; ++tick) pilot.step();
        const double bank = pilot.world.inspect().bank_deg;
        fastest_dps = std::max(fastest_dps, std::abs(bank - before) * 4.0);
        before = bank;
        if (std::abs(bank - 46.0) > 3.0) taken_s = pilot.world.truth().e_s - 98.0;
    }
    CHECK(fastest_dps < 21.0);
    CHECK(fastest_dps > 12.0);
    CHECK(taken_s > 7.5);  // [od137]: from -45 to 56 degrees between E+94 and 102
    CHECK(taken_s < 12.0);
}

TEST_CASE("thrusters take the spin out and turn to the entry attitude before the air is felt",
          "[simulation][attitude][R27]") {
    tests::TruthPilot pilot{tests::undisturbed_scenario(620.0)};
    pilot.run_until(-506.0);
    CHECK(vector3(pilot.world.inspect().rate_B_rps).norm() < 0.5 * degree_rad);  // [od137]: nil by E-452
    pilot.run_until(0.0);
    CHECK(vector3(pilot.world.inspect().rate_B_rps).norm() < 0.5 * degree_rad);
    CHECK(pilot.world.inspect().angle_of_attack_deg == Approx(16.0).margin(1.0));
}

}  // namespace simulation_attitude_test
