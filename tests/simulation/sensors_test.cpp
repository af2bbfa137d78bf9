// SPDX-License-Identifier: Apache-2.0
#include "simulation/sensors/imu.hpp"
#include "simulation/sensors/radar.hpp"
#include "simulation/sensors/rover_imu.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

namespace simulation_sensors_test {

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
    pilot.step();  // brings the readings up to the start, which are of the past
    while (pilot.world.truth().e_s < 95.0) {
        pilot.step();
        navigate();
    }
    pilot.imu = pilot.world.sense().imu;  // of the last tick
    navigate();
    const World& world = pilot.world;
    const auto truth = world.truth();
    CHECK((at.v_MB_M - vector3(truth.v_MB_M_mps)).norm() < 0.05);  // of 3500 m/s taken away
    CHECK((at.p_MoB_M - vector3(truth.p_MoB_M_m)).norm() < 3.0);
}

TEST_CASE("the IMU gives 200 readings a second, three or four a tick, and counts them", "[simulation][imu]") {
    World world{tests::gale_scenario(620.0), 1};
    std::uint32_t count = 0;
    for (int tick = 0; tick <= 64; ++tick) {
        const auto& in = world.sense();
        if (tick > 0) CHECK((in.imu.size() == 3 || in.imu.size() == 4));
        for (const auto& reading : in.imu) CHECK(reading.count == ++count);
        world.advance(flight::DeviceOutputs{});
    }
    CHECK(count == 200);
}

TEST_CASE("a radar beam measures slant range and closing speed to the ground below", "[simulation][radar]") {
    const Dispersions none = tests::undisturbed_scenario().dispersions;
    constexpr double ground_m = 3391148.0;
    Radar radar{none, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                Random{1, 0, Stream::radar_sand}};
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
    const Dispersions none = tests::undisturbed_scenario().dispersions;
    Radar radar{none, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                Random{1, 0, Stream::radar_sand}};
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

TEST_CASE("a beam measures up to its own range, and nothing nearer than four metres", "[simulation][radar]") {
    const Dispersions none = tests::undisturbed_scenario().dispersions;
    Radar radar{none, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                Random{1, 0, Stream::radar_sand}};
    const Terrain flat{tests::undisturbed_scenario(), Random{1, 0, Stream::terrain}};
    const Vector3 up = Vector3::UnitX();
    const Quaternion down = Quaternion::FromTwoVectors(Vector3::UnitZ(), -up);
    const auto measures = [&](std::uint32_t beam, double altitude_m) {
        return radar.measure(beam, {(3391148.0 + altitude_m) * up, -80.0 * up}, down, flat).valid;
    };
    const double slant_20 = std::cos(20.0 * degree_rad), slant_50 = std::cos(50.0 * degree_rad);
    CHECK(measures(1, 11900.0 * slant_20));
    CHECK_FALSE(measures(1, 12100.0 * slant_20));
    CHECK(measures(4, 8900.0 * slant_50));
    CHECK_FALSE(measures(4, 9100.0 * slant_50));
    CHECK(measures(0, 4.1));
    CHECK_FALSE(measures(0, 3.9));
}

TEST_CASE("on a slope the beam that would graze it measures nothing, the one across from it does",
          "[simulation][radar]") {
    Scenario scenario = tests::undisturbed_scenario();
    scenario.ground.slope_deg = 18.0;
    const Terrain slope{scenario, Random{1, 0, Stream::terrain}};
    Radar radar{scenario.dispersions, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                Random{1, 0, Stream::radar_sand}};
    const Horizon at = horizon(place(scenario.target.latitude_deg * degree_rad,
                                     scenario.target.longitude_deg * degree_rad, scenario.target.radius_m));
    // Beams 4 and 5 look 50° to either side; here along the rise, which is to the north.
    Eigen::Matrix3d axes;
    axes.col(2) = -at.up;
    axes.col(0) = std::cos(60.0 * degree_rad) * at.north - std::sin(60.0 * degree_rad) * axes.col(2).cross(at.north);
    axes.col(1) = axes.col(2).cross(axes.col(0));
    const Quaternion q_MB{axes};
    const PointMass above{(slope.radius_m(at.up) + 1000.0) * at.up, Vector3::Zero()};
    const auto uphill = radar.measure(4, above, q_MB, slope), downhill = radar.measure(5, above, q_MB, slope);
    CHECK(uphill.valid);
    CHECK(uphill.range_m < 1000.0 / std::cos(50.0 * degree_rad));
    CHECK_FALSE(downhill.valid);
}

TEST_CASE("the part of the radar's readings that the scenario says fails, and by its own draws",
          "[simulation][radar]") {
    Dispersions some = tests::undisturbed_scenario().dispersions;
    some.radar_range_fraction = 0.01;
    const Terrain flat{tests::undisturbed_scenario(), Random{1, 0, Stream::terrain}};
    const Vector3 up = Vector3::UnitX();
    const Quaternion down = Quaternion::FromTwoVectors(Vector3::UnitZ(), -up);
    const PointMass at{(3391148.0 + 1000.0) * up, -80.0 * up};
    Radar whole{some, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                Random{1, 0, Stream::radar_sand}};
    some.radar_dropout_fraction = 0.2;
    Radar failing{some, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                  Random{1, 0, Stream::radar_sand}};
    int failed = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto reading = failing.measure(0, at, down, flat), same = whole.measure(0, at, down, flat);
        failed += !reading.valid;
        if (reading.valid) CHECK(reading.range_m == same.range_m);
    }
    CHECK(failed / 2000.0 == Approx(0.2).margin(0.03));
}

TEST_CASE("the heatshield hides the beams that it stands in, until it is ninety metres off", "[simulation][radar]") {
    const Vector3 ahead = Vector3::UnitZ();
    const auto tilted = [](double deg) { return Vector3{std::sin(deg * degree_rad), 0.0, std::cos(deg * degree_rad)}; };
    CHECK(Radar::hides(1.0 * ahead, tilted(50.0)));
    CHECK(Radar::hides(5.0 * ahead, tilted(20.0)));
    CHECK_FALSE(Radar::hides(5.0 * ahead, tilted(50.0)));
    CHECK(Radar::hides(60.0 * ahead, ahead));
    CHECK_FALSE(Radar::hides(60.0 * ahead, tilted(20.0)));
    CHECK_FALSE(Radar::hides(91.0 * ahead, ahead));
}

TEST_CASE("a turned IMU tells what the vehicle feels and how it turns along its own axes", "[simulation][imu]") {
    Dispersions turned = tests::undisturbed_scenario().dispersions;
    turned.imu_misalignment_rad = 0.01;
    const Random any{1, 0, Stream::imu};
    Imu imu{turned, any, Random{1, 0, Stream::imu_mounting}};
    const Quaternion q_MB = rotation({0.3, -0.2, 0.5});
    const Vector3 rate_B{0.1, 0.05, -0.2}, force_B{1.0, -2.0, 3.0};
    const Quaternion end = q_MB * rotation(0.005 * rate_B);
    imu.integrate(q_MB * force_B, q_MB, end, 0.005);
    const auto reading = imu.read(1);
    const Vector3 felt = vector3(reading.delta_v_mps) / 0.005, angle = vector3(reading.delta_angle_rad) / 0.005;
    CHECK(felt.norm() == Approx(force_B.norm()).epsilon(1e-5));
    const double off_rad = (felt - force_B).norm() / force_B.norm();
    CHECK(off_rad > 1e-3);
    CHECK(off_rad < 0.04);
    // Both are turned by the same small rotation, so the angle between them is kept.
    const Vector3 rate_I = rate_B + q_MB.conjugate() * Vector3{0.0, 0.0, mars_spin_rps};
    CHECK(felt.dot(angle) == Approx(force_B.dot(rate_I)).epsilon(1e-3));
    Dispersions straight = turned;
    straight.imu_misalignment_rad = 0.0;
    Imu other{straight, any, Random{1, 0, Stream::imu_mounting}};
    other.integrate(q_MB * force_B, q_MB, end, 0.005);
    CHECK((vector3(other.read(1).delta_v_mps) / 0.005 - force_B).norm() < 2e-3);
}

TEST_CASE("a gyro's scale error grows with the turn, along each axis by its own", "[simulation][imu]") {
    Dispersions scaled = tests::undisturbed_scenario().dispersions;
    scaled.gyro_scale_fraction = 0.01;
    const Random any{1, 0, Stream::imu};
    const auto error_rad = [&](double rate_rps) {
        Imu imu{scaled, any, Random{1, 0, Stream::imu_mounting}};
        const Vector3 inertial_rate_B{rate_rps, rate_rps, rate_rps};
        const Vector3 rate_B = inertial_rate_B - Vector3{0.0, 0.0, mars_spin_rps};
        imu.integrate(Vector3::Zero(), Quaternion::Identity(), rotation(0.005 * rate_B), 0.005);
        return Vector3{vector3(imu.read(1).delta_angle_rad) - 0.005 * inertial_rate_B};
    };
    const Vector3 once = error_rad(0.1), twice = error_rad(0.2);
    CHECK(once.norm() > 1.0e-6);
    CHECK((twice - 2.0 * once).norm() < 0.01 * once.norm());
    CHECK(once.x() != once.y());
}

TEST_CASE("each radar beam measures twenty times a second", "[simulation][radar]") {
    for (std::uint32_t beam = 0; beam < Radar::beams; ++beam) {
        int count = 0;
        for (std::int64_t tick = 1000; tick < 1640; ++tick) count += Radar::due(beam, (tick - 1) * 25, tick * 25);
        CHECK(count == 200);
    }
}

TEST_CASE("the rover's IMU measures what the rover feels, with errors of the scenario that its seed draws",
          "[simulation][imu]") {
    const Vector3 force{1.0, -2.0, 3.0}, rate{0.1, 0.2, -0.3};
    const auto force_error = [&](const Dispersions& dispersions, std::uint64_t seed) {
        RoverImu imu{dispersions, Random{seed, 0, Stream::rover_imu}};
        return Vector3{vector3(imu.measure(force, rate).force_mps2) - force};
    };
    RoverImu perfect{tests::undisturbed_scenario().dispersions, Random{1, 0, Stream::rover_imu}};
    const auto reading = perfect.measure(force, rate);
    CHECK((vector3(reading.force_mps2) - force).norm() == 0.0);
    CHECK((vector3(reading.rate_rps) - rate).norm() == 0.0);
    const Dispersions shipped{};
    CHECK(force_error(shipped, 1) == force_error(shipped, 1));
    CHECK(force_error(shipped, 1) != force_error(shipped, 2));
    double sum = 0.0;
    constexpr int seeds = 400;
    for (int seed = 1; seed <= seeds; ++seed) sum += force_error(shipped, seed).squaredNorm();
    const double noise_mps2 = shipped.imu_noise_mps * 200.0;  // by far the largest of its errors
    CHECK(std::sqrt(sum / (3.0 * seeds)) == Approx(noise_mps2).epsilon(0.1));
}

TEST_CASE("moving sand spoils some velocities on the sky crane, and nothing else of the radar",
          "[simulation][sensors]") {
    Scenario scenario = tests::undisturbed_scenario();
    const PointMass at{place(scenario.target.latitude_deg * degree_rad, scenario.target.longitude_deg * degree_rad,
                             scenario.target.radius_m + 20.0),
                       Vector3::Zero()};
    const Quaternion down = Quaternion::FromTwoVectors(Vector3::UnitZ(), -at.p_MoB_M);
    const Terrain terrain{scenario, Random{1, 0, Stream::terrain}};
    Dispersions sandy = scenario.dispersions;
    sandy.radar_sand_mps = 0.5;
    const auto radar = [](const Dispersions& dispersions) {
        return Radar{dispersions, Random{1, 0, Stream::radar}, Random{1, 0, Stream::radar_dropout},
                     Random{1, 0, Stream::radar_sand}};
    };
    Radar clean = radar(scenario.dispersions), spoilt = radar(sandy), still = radar(sandy);
    int differ = 0;
    double squares = 0.0;
    constexpr int readings = 20000;
    for (int i = 0; i < readings; ++i) {
        const auto expected = clean.measure(0, at, down, terrain, true);
        const auto told = spoilt.measure(0, at, down, terrain, true);
        REQUIRE(told.range_m == expected.range_m);
        REQUIRE(still.measure(0, at, down, terrain, false).range_rate_mps == expected.range_rate_mps);
        const double by_mps = told.range_rate_mps - expected.range_rate_mps;
        differ += by_mps != 0.0 ? 1 : 0;
        squares += by_mps * by_mps;
    }
    CHECK(differ / static_cast<double>(readings) == Approx(0.05).margin(0.01));
    CHECK(std::sqrt(squares / differ) == Approx(0.5).epsilon(0.1));
}

}  // namespace simulation_sensors_test
