// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/effectors.hpp"
#include "flight/gnc/powered_descent/thrust_allocation.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>

namespace flight_gnc_thrust_allocation_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::powered_descent;
constexpr aeolis::flight::Parameters parameters;

namespace {
constexpr double largest_N = 3603.0;
const Vector3 up = Vector3::UnitX();
double sum_N(const Thrust& thrust) {
    double sum = 0.0;
    for (const double throttle : thrust.throttle) sum += throttle * largest_N;
    return sum;
}
}  // namespace

TEST_CASE("eight engines share the thrust that mass and acceleration need", "[gnc][R27]") {
    const Thrust thrust = allocate(parameters, {6.9, 2.0, -1.0}, up, 2200.0, 8, largest_N);
    CHECK(thrust.magnitude_N == Approx(2200.0 * Vector3(6.9, 2.0, -1.0).norm()));
    CHECK(sum_N(thrust) == Approx(thrust.magnitude_N));
    CHECK((thrust.direction_M - Vector3(6.9, 2.0, -1.0).normalized()).norm() < 1e-12);
}

TEST_CASE("of four engines every other one runs", "[gnc][R27]") {
    const Thrust thrust = allocate(parameters, 3.71 * up, up, 2040.0, 4, largest_N);
    for (std::size_t i = 0; i < 8; ++i) CHECK((thrust.throttle[i] > 0.0) == (i % 2 == 0));
    CHECK(sum_N(thrust) == Approx(2040.0 * 3.71));
}

TEST_CASE("an engine gives 400 to 3060 N", "[gnc][R27]") {
    CHECK(allocate(parameters, 100.0 * up, up, 2200.0, 8, largest_N).magnitude_N == Approx(8 * 3060.0));
    CHECK(allocate(parameters, 0.01 * up, up, 2200.0, 8, largest_N).magnitude_N == Approx(8 * 400.0));
}

TEST_CASE("the sidestep gives way before lift does, and tilt stays within 60°", "[gnc][R27]") {
    const Thrust steep = allocate(parameters, {7.0, 50.0, 0.0}, up, 2200.0, 8, largest_N);
    CHECK(steep.direction_M.dot(up) * steep.magnitude_N / 2200.0 == Approx(7.0));
    const Thrust flat = allocate(parameters, {1.0, 50.0, 0.0}, up, 2200.0, 8, largest_N);
    CHECK(flat.direction_M.dot(up) >= 0.5 - 1e-9);
    CHECK((allocate(parameters, Vector3::Zero(), up, 2200.0, 8, largest_N).direction_M - up).norm() < 1e-12);
}

TEST_CASE("a torque is spread over eight engines or four without changing their sum, which gives way at their limits",
          "[gnc][R27]") {
    using namespace aeolis::flight;
    constexpr auto mounted = descent_engines();
    const powered_descent::TorqueAllocation allocation;
    for (const int engines : {8, 4}) {
        for (const Vector3& torque :
             {Vector3{400.0, -250.0, 0.0}, Vector3{0.0, 0.0, 90.0}, Vector3{-30000.0, 0.0, 0.0}}) {
            double given_N = 0.0;
            auto throttle = powered_descent::throttles_for(parameters, 1400.0 * engines, engines, 3603.0, given_N);
            allocation.add(parameters, torque, engines, 3603.0, throttle);
            double sum_N = 0.0;
            Vector3 turns = Vector3::Zero();
            for (std::size_t i = 0; i < throttle.size(); ++i) {
                const double thrust_N = throttle[i] * 3603.0;
                if (engines == 4 && i % 2 == 1) {
                    CHECK(throttle[i] == 0.0);
                    continue;
                }
                CHECK(thrust_N >= parameters.engine_used_min_N - 1e-6);
                CHECK(thrust_N <= parameters.engine_used_max_N + 1e-6);
                sum_N += thrust_N;
                turns += thrust_N * to_vector(mounted[i].position_B_m).cross(to_vector(mounted[i].direction_B));
            }
            if (torque.norm() < 1000.0) {
                CHECK(sum_N == Approx(given_N));
                CHECK((turns - torque).norm() < 1e-6);
            } else {  // too much: less of it, about the same axis
                CHECK(turns.normalized().dot(torque.normalized()) > 0.999);
            }
        }
    }
}

TEST_CASE("engines at their limit give way to a torque: attitude comes before thrust", "[gnc][R27]") {
    const powered_descent::TorqueAllocation allocation;
    double given_N = 0.0;
    auto throttle = powered_descent::throttles_for(parameters, 1.0e6, 8, 3603.0, given_N);
    allocation.add(parameters, {1500.0, 0.0, 0.0}, 8, 3603.0, throttle);
    double sum_N = 0.0, most_N = 0.0;
    for (const double each : throttle) {
        sum_N += each * 3603.0;
        most_N = std::max(most_N, each * 3603.0);
    }
    CHECK(most_N == Approx(parameters.engine_used_max_N));
    CHECK(sum_N < given_N - 1000.0);
}

// Found by mailbox_fuzz: the two ends of what was left passed each other by one rounding. R21
TEST_CASE("a torque of any size leaves the engines within their range", "[gnc][R27]") {
    const powered_descent::TorqueAllocation allocation;
    for (const int engines : {8, 4}) {
        for (int step = 0; step < 4000; ++step) {
            const double size_Nm = std::pow(10.0, 2.0 + step * 0.004), angle = step * 0.7;
            const Vector3 torque{size_Nm * std::cos(angle), size_Nm * std::sin(angle), size_Nm * std::cos(3.0 * angle)};
            double given_N = 0.0;
            auto throttle = powered_descent::throttles_for(parameters, 1400.0 * engines, engines, largest_N, given_N);
            allocation.add(parameters, torque, engines, largest_N, throttle);
            for (std::size_t i = 0; i < throttle.size(); i += engines == 4 ? 2 : 1) {
                REQUIRE(throttle[i] * largest_N >= parameters.engine_used_min_N - 1e-6);
                REQUIRE(throttle[i] * largest_N <= parameters.engine_used_max_N + 1e-6);
            }
        }
    }
}

}  // namespace flight_gnc_thrust_allocation_test
