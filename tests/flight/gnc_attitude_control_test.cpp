// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/attitude_control.hpp"

#include "tests/support/catch.hpp"

namespace flight_gnc_attitude_control_test {

using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;
using Mode = AttitudeCommand::Mode;

namespace {

const Inertia inertia{4300.0, 5000.0};

AttitudeState flying_east() {
    AttitudeState state;
    state.p_MoB_M = {3.5e6, 0.0, 0.0};
    state.v_MB_M = {-500.0, 5000.0, 0.0};
    return state;
}

/// Turns freely by the torque that control asks for; the rest of the state stands still.
AttitudeState steered(AttitudeState state, const AttitudeCommand& command, double for_s) {
    constexpr double cycle_s = 1.0 / 64;
    for (double t = 0.0; t < for_s; t += cycle_s) {
        const Vector3 torque = control_torque(parameters, command, state, inertia);
        const Vector3 gyroscopic = state.rate_B_rps.cross(inertia.times(state.rate_B_rps));
        const Vector3 net = torque - gyroscopic;
        state.rate_B_rps +=
            cycle_s * Vector3{net.x() / inertia.across, net.y() / inertia.across, net.z() / inertia.along_z};
        const Vector3 half = 0.5 * cycle_s * state.rate_B_rps;
        state.q_MB = (state.q_MB * Quaternion{1.0, half.x(), half.y(), half.z()}).normalized();
    }
    return state;
}

double bank_of(const AttitudeState& state) {
    return -bank_error(0.0, state);
}

}  // namespace

TEST_CASE("nothing is steered in idle, and a tumbling vehicle comes to rest in detumble", "[gnc][R27]") {
    AttitudeState state = flying_east();
    state.rate_B_rps = {0.02, -0.03, 0.21};  // 2 rpm and a little nutation
    CHECK(control_torque(parameters, {}, state, inertia).isZero());
    AttitudeCommand command;
    command.mode = Mode::detumble;
    state = steered(state, command, 60.0);
    CHECK(state.rate_B_rps.norm() <= 0.16 * degree);  // its deadband
}

TEST_CASE("in vacuum the vehicle turns to its trim attitude at the wanted bank from anywhere", "[gnc][R27]") {
    for (const double bank_deg : {77.0, -120.0}) {
        AttitudeState state = flying_east();
        state.q_MB = Quaternion{0.1, -0.7, 0.4, 0.5}.normalized();
        AttitudeCommand command;
        command.mode = Mode::entry_bank;
        command.bank_rad = bank_deg * degree;
        state = steered(state, command, 180.0);
        CHECK(bank_of(state) / degree == Approx(bank_deg).margin(2.0));
        const double angle = std::acos((state.q_MB * Vector3::UnitZ()).dot(state.v_MB_M.normalized()));
        CHECK(angle / degree == Approx(16.0).margin(0.6));
        // Lift points away from where the heatshield leans.
        const Vector3 right = state.v_MB_M.cross(state.p_MoB_M).normalized();
        CHECK(-(state.q_MB * Vector3::UnitZ()).dot(right) * std::sin(command.bank_rad) > 0.0);
    }
}

TEST_CASE("in the air bank is turned about the velocity the short way, and the angle of attack is left to the air",
          "[gnc][R27]") {
    AttitudeState state = flying_east();
    AttitudeCommand command;
    command.mode = Mode::entry_bank;
    command.bank_rad = 170.0 * degree;
    state = steered(state, command, 240.0);
    state.in_air = true;
    const Vector3 forward_B = state.q_MB.conjugate() * state.v_MB_M.normalized();
    command.bank_rad = -170.0 * degree;  // 20° further, not 340° back
    CHECK(control_torque(parameters, command, state, inertia).dot(forward_B) > 0.0);
    state = steered(state, command, 20.0);
    CHECK(std::abs(bank_error(command.bank_rad, state)) / degree < 1.5);
    CHECK((state.q_MB.conjugate() * state.v_MB_M.normalized() - forward_B).norm() < 0.05);
}

TEST_CASE("on engines -z is laid along the wanted thrust within a second or two, without roll", "[gnc][R27]") {
    AttitudeState state = flying_east();
    state.q_MB = Quaternion::FromTwoVectors(Vector3::UnitZ(), -Vector3::UnitX());
    AttitudeCommand command;
    command.mode = Mode::thrust;
    const Vector3 wanted = Vector3{1.0, 0.5, -0.3}.normalized();
    command.thrust_direction_M = to_array(wanted);
    state = steered(state, command, 3.0);
    CHECK((state.q_MB * -Vector3::UnitZ()).dot(wanted) > 0.9995);
    CHECK(std::abs(state.rate_B_rps.z()) < 1.0e-3);
}

TEST_CASE("under the parachute small swings are left alone and large ones are damped", "[gnc][R27]") {
    AttitudeState state = flying_east();
    AttitudeCommand command;
    command.mode = Mode::suspended;
    state.rate_B_rps = {2.0 * degree, 0.0, 0.0};
    CHECK(control_torque(parameters, command, state, inertia).isZero());
    state.rate_B_rps = {8.0 * degree, 0.0, 0.0};
    CHECK(control_torque(parameters, command, state, inertia).x() < 0.0);
}

}  // namespace flight_gnc_attitude_control_test
