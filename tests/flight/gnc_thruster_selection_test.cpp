// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/thruster_selection.hpp"

#include "common/time.hpp"
#include "flight/devices/effectors.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <random>

namespace flight_gnc_thruster_selection_test {

using namespace aeolis;
using namespace aeolis::flight;
using namespace aeolis::flight::gnc;

namespace {

/// Angular impulse of a command. [N m s]
Vector3 given(const ThrusterCommand& command) {
    constexpr auto thrusters = entry_thrusters();
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < thrusters.size(); ++i)
        sum += command.on_s[i] * thruster_force_N *
               to_vector(thrusters[i].position_B_m).cross(to_vector(thrusters[i].direction_B));
    return sum;
}

}  // namespace

TEST_CASE("a torque that thrusters can give is given in its cycle, about its own axis", "[gnc][R27]") {
    std::mt19937 random{5};
    std::uniform_real_distribution<double> any{-1.0, 1.0};
    for (int i = 0; i < 200; ++i) {
        ThrusterSelection selection;
        const Vector3 torque = Vector3{any(random), any(random), any(random)}.normalized() * 900.0;
        const ThrusterCommand command = selection.select(torque);
        CHECK((given(command) - torque * seconds_per_tick).norm() < 2.0 * thruster_least_on_s * thruster_force_N * 2.2);
        for (std::size_t mount = 0; mount < thruster_count; mount += 2)  // never one against the other
            CHECK((command.on_s[mount] == 0.0 || command.on_s[mount + 1] == 0.0));
    }
}

TEST_CASE("what is too small for a valve is given as rare pulses, and none is lost", "[gnc][R27]") {
    ThrusterSelection selection;
    const Vector3 torque{7.0, -4.0, 11.0};
    Vector3 sum = Vector3::Zero();
    int pulses = 0;
    for (int cycle = 0; cycle < 64 * 60; ++cycle) {
        const ThrusterCommand command = selection.select(torque);
        sum += given(command);
        for (const double on_s : command.on_s) {
            CHECK((on_s == 0.0 || on_s >= thruster_least_on_s));
            pulses += on_s > 0.0;
        }
    }
    CHECK((sum - torque * 60.0).norm() / (60.0 * torque.norm()) < 0.02);
    CHECK(pulses < 64 * 60);
}

TEST_CASE("a torque beyond all thrusters is cut in proportion, and keeps its axis", "[gnc][R27]") {
    ThrusterSelection selection;
    const Vector3 torque{9000.0, 3000.0, -2000.0};
    const ThrusterCommand command = selection.select(torque);
    CHECK(given(command).normalized().dot(torque.normalized()) > 0.999);
    CHECK(*std::max_element(command.on_s.begin(), command.on_s.end()) == Approx(seconds_per_tick));
    CHECK(selection.select(Vector3::Zero()) == ThrusterCommand{});  // and none is owed afterwards
}

}  // namespace flight_gnc_thruster_selection_test
