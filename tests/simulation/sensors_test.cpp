#include "simulation/sensors/imu.hpp"
#include "simulation/sensors/radar.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

using namespace aeolis;
using namespace aeolis::simulation;

TEST_CASE("a perfect IMU's readings carry the vehicle along its true path", "[simulation][imu]") {
    // From turned-to-entry through the first reversal: navigate with nothing but the readings and the start.
    tests::TruthPilot pilot{tests::undisturbed_scenario(620.0)};
    pilot.run_until(20.0);
    const auto start = pilot.world.truth();
    PointMass at{vector3(start.p_MoB_M_m), vector3(start.v_MB_M_mps)};
    const auto q = pilot.world.inspect().q_MB;
    Quaternion q_MB{q[0], q[1], q[2], q[3]};
    // 20 s is a multiple of 1/8 s from the start: there a reading ends with the tick.
    const auto navigate = [&] {
        for (const auto& reading : pilot.imu) {
            const Vector3 angle = vector3(reading.delta_angle_rad);
            const Quaternion middle = q_MB * rotation(0.5 * angle);
            const Vector3 force = middle * vector3(reading.delta_v_mps) / 0.005;
            at = runge_kutta_step(at, 0.005, [&](double, const Vector3&, const Vector3&) -> Vector3 { return force; });
            q_MB = (rotation({0, 0, -mars_spin_rps * 0.005}) * q_MB * rotation(angle)).normalized();
        }
    };
    pilot.step(); // brings the readings up to the start, which are of the past
    while (pilot.world.truth().e_s < 95.0) {
        pilot.step();
        navigate();
    }
    pilot.imu = pilot.world.sense().imu; // of the last tick
    navigate();
    const World& world = pilot.world;
    const auto truth = world.truth();
    CHECK((at.v_MB_M - vector3(truth.v_MB_M_mps)).norm() < 0.05); // of 3500 m/s taken away
    CHECK((at.p_MoB_M - vector3(truth.p_MoB_M_m)).norm() < 3.0);
}

TEST_CASE("the IMU gives 200 readings a second, three or four a tick, and counts them", "[simulation][imu]") {
    World world{tests::gale_scenario(620.0), 1};
    std::uint32_t count = 0;
    for (int tick = 0; tick <= 64; ++tick) {
        const auto& in = world.sense();
        if (tick > 0) CHECK((in.imu.size() == 3 || in.imu.size() == 4));
        for (const auto& reading : in.imu)
            CHECK(reading.count == ++count);
        world.advance(flight::DeviceOutputs{});
    }
    CHECK(count == 200);
}

TEST_CASE("a radar beam measures slant range and closing speed to the ground below", "[simulation][radar]") {
    const Dispersions none = tests::undisturbed_scenario().dispersions;
    constexpr double ground_m = 3391148.0;
    Radar radar{none, Random{1, 0, Stream::radar}};
    const Terrain flat{tests::undisturbed_scenario(), Random{1, 0, Stream::terrain}};
    const Vector3 up = Vector3::UnitX();
    const PointMass at{(ground_m + 2000.0) * up, -80.0 * up + 10.0 * Vector3::UnitY()};
    const Quaternion down = Quaternion::FromTwoVectors(Vector3::UnitZ(), -up);

    const auto nadir = radar.measure(0, at, down, flat);
    REQUIRE(nadir.valid);
    CHECK(nadir.range_m == Approx(2000.0));
    CHECK(nadir.range_rate_mps == Approx(-80.0));

    const auto slanted = radar.measure(1, at, down, flat);
    REQUIRE(slanted.valid);
    CHECK(slanted.range_m == Approx(2000.0 / std::cos(20.0 * degree_rad)).epsilon(1e-3));
    const Vector3 direction = down * vector3(slanted.direction_B);
    CHECK(slanted.range_rate_mps == Approx(-at.v_MB_M.dot(direction)));
    CHECK(direction.dot(-up) == Approx(std::cos(20.0 * degree_rad)));
}

TEST_CASE("a beam that is out of range, too flat or turned away measures nothing", "[simulation][radar]") {
    Radar radar{Dispersions{}, Random{1, 0, Stream::radar}};
    const Terrain flat{tests::undisturbed_scenario(), Random{1, 0, Stream::terrain}};
    const Vector3 up = Vector3::UnitX();
    const Quaternion down = Quaternion::FromTwoVectors(Vector3::UnitZ(), -up);
    const auto at = [&](double altitude_m) { return PointMass{(3391148.0 + altitude_m) * up, -80.0 * up}; };
    CHECK(radar.measure(0, at(11500.0), down, flat).valid);
    CHECK_FALSE(radar.measure(0, at(12500.0), down, flat).valid);
    const Quaternion tilted = down * rotation({0.0, 70.0 * degree_rad, 0.0});
    CHECK_FALSE(radar.measure(0, at(500.0), tilted, flat).valid);
    const Quaternion away = down * rotation({std::numbers::pi, 0.0, 0.0});
    CHECK_FALSE(radar.measure(0, at(500.0), away, flat).valid);
}

TEST_CASE("each radar beam measures twenty times a second", "[simulation][radar]") {
    for (std::uint32_t beam = 0; beam < Radar::beams; ++beam) {
        int count = 0;
        for (std::int64_t tick = 1000; tick < 1640; ++tick)
            count += Radar::due(beam, (tick - 1) * 25, tick * 25);
        CHECK(count == 200);
    }
}
