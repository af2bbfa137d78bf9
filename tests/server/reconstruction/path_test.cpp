// SPDX-License-Identifier: Apache-2.0
// Landings rebuilt from their recordings, and compared with the truth, which the reconstruction never sees.
#include "server/reconstruction/path.hpp"

#include "tests/server/reconstruction/flown_landing.hpp"
#include "tests/simulation/gale.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace server_reconstruction_path_test {

using namespace aeolis;
using namespace aeolis::reconstruction;
using tests::Flown;
using tests::NavigatedState;
using tests::rebuilt;

namespace {

constexpr double degree = flight::gnc::degree;

/// Largest errors against the truth, as they are, and in standard deviations of the three axes together.
struct Worst {
    double height_sigmas = 0.0;  ///< along up
    double p_m = 0.0, height_m = 0.0, v_mps = 0.0, angle_deg = 0.0;
    double p_sigmas = 0.0, v_sigmas = 0.0, angle_sigmas = 0.0;
    std::size_t points = 0;
};

Worst worst_of(const Path& path, const Flown& flown, double from_s = -1e9) {
    Worst worst;
    for (const PathPoint& point : path.points) {
        const auto truth = flown.true_at(point.at);
        if (!truth || point.at - path.entry < from_s) continue;
        ++worst.points;
        const auto take = [](double& most, double& most_sigmas, double error, double sigma) {
            most = std::max(most, error);
            most_sigmas = std::max(most_sigmas, error / sigma);
        };
        const double angle_deg = point.state.q_MB.angularDistance(truth->q_MB) / degree;
        take(worst.p_m, worst.p_sigmas, (point.state.p_MoB_M - truth->p_MoB_M).norm(), point.sigma_p_m.norm());
        take(worst.v_mps, worst.v_sigmas, (point.state.v_MB_M - truth->v_MB_M).norm(), point.sigma_v_mps.norm());
        take(worst.angle_deg, worst.angle_sigmas, angle_deg, point.sigma_angle_rad.norm() / degree);
        take(worst.height_m, worst.height_sigmas, std::abs(point.state.p_MoB_M.norm() - truth->p_MoB_M.norm()),
             point.sigma_height_m);
    }
    return worst;
}

std::string text_of(const char* what, const Worst& worst) {
    return std::string(what) + ": " + std::to_string(worst.p_m) + " m (" + std::to_string(worst.p_sigmas) +
           " sigma), height " + std::to_string(worst.height_m) + " m (" + std::to_string(worst.height_sigmas) + "), " +
           std::to_string(worst.v_mps) + " m/s (" + std::to_string(worst.v_sigmas) + "), " +
           std::to_string(worst.angle_deg) + " deg (" + std::to_string(worst.angle_sigmas) + ")";
}

// The bounds, from SensorErrors. Three standard deviations of three axes together:
constexpr double sigmas_max = 3.0;
// height: of the map (10 m) and of the ground's relief over the 150 s in which the radar sees it (12 m);
constexpr double height_at_end_max_m = sigmas_max * 16.0;
// and at entry, 430 s and 600 km earlier: by what velocity and attitude at the radar's end leave open;
constexpr double height_known_m = 300.0;
// velocity: of the beams' biases (0.033 m/s over six of them) and of what is not modelled.
constexpr double velocity_at_end_max_mps = sigmas_max * 0.04;

const Flown& dispersed() {
    static const Flown once{tests::gale_scenario(900.0), 1};
    return once;
}

bool is(const std::vector<std::uint8_t>& packet, const char* name) {
    return Apid{static_cast<std::uint16_t>(read_bits(packet, 5, 11))} == tests::shipped_dictionary().packet(name)->apid;
}

/// The path is as good as it says, at each of its points.
void check_claims(const Path& path, const Flown& flown) {
    const Worst all = worst_of(path, flown);
    INFO(text_of("all", all));
    CHECK(all.points > 8 * 440);
    CHECK(all.p_sigmas < sigmas_max);
    CHECK(all.height_sigmas < sigmas_max);
    CHECK(all.v_sigmas < sigmas_max);
    CHECK(all.angle_sigmas < sigmas_max);
}

void check_bounds(const Path& path, const Flown& flown) {
    check_claims(path, flown);
    const Worst end = worst_of(path, flown, path.points.back().at - path.entry - 10.0);
    INFO(text_of("last ten seconds", end));
    CHECK(end.height_m < height_at_end_max_m);
    CHECK(end.v_mps < velocity_at_end_max_mps);
}

}  // namespace

TEST_CASE("a landing whose sensors and solution have no errors is rebuilt to what its navigation's clock allows",
          "[reconstruction][R52]") {
    const Flown flown{tests::undisturbed_scenario(900.0), 1};
    const auto path = rebuilt(flown);
    REQUIRE(path);
    const Worst worst = worst_of(*path, flown);
    INFO(text_of("all", worst));
    // Flight takes the IMU's readings, each up to 5 ms old, for those of the tick: 29 m along the path at entry.
    CHECK(worst.p_m < 5.9e3 * flight::gnc::imu_period_s);
    CHECK(worst.v_mps < 0.02);
    CHECK(worst.angle_deg < 1e-3);
    CHECK(path->readings_filled == 0);
    CHECK(path->breaks == 0);
    CHECK(path->beams_refused < path->beams_taken / 100);
}

TEST_CASE("the path of a landing is rebuilt from its recording alone, as well as its sensors' errors allow",
          "[reconstruction][R52]") {
    const auto path = rebuilt(dispersed());
    REQUIRE(path);
    CHECK(path->points.front().at - path->entry < -29.0);
    const auto touchdown = [&] {
        auto recorded = RecordedLanding::with(tests::shipped_dictionary());
        for (const auto& packet : dispersed().packets) recorded->add(packet);
        return recorded->reported("TOUCHDOWN");
    }();
    REQUIRE(touchdown);
    CHECK(*touchdown - path->points.back().at < path_step_s);
    check_bounds(*path, dispersed());
    // The height is known better than the place: by the radar, back to the entry.
    for (const PathPoint& point : path->points) CHECK(point.sigma_height_m < height_known_m);
    const auto& end = path->points.back();
    CHECK(end.sigma_p_m.norm() < 1.1 * std::sqrt(3.0) * SensorErrors{}.position_m);
    CHECK(end.sigma_v_mps.norm() < 0.1);
    CHECK(end.sigma_angle_rad.norm() < 1e-3);  // better than the star scanner's 1.5e-3 on each axis
}

TEST_CASE("other landings are rebuilt, too", "[reconstruction][R52]") {
    for (const std::uint64_t seed : {2U, 5U}) {
        const Flown flown{tests::gale_scenario(900.0), seed};
        const auto path = rebuilt(flown);
        REQUIRE(path);
        INFO("seed " << seed);
        check_bounds(*path, flown);
    }
}

TEST_CASE("what flight navigated agrees with the rebuilt path within what its own sensors allow",
          "[reconstruction][R52]") {
    const auto path = rebuilt(dispersed());
    REQUIRE(path);
    const SensorErrors errors;
    // Before the radar: the velocity's error, and attitude's by all that was sensed: 5.5 km/s.
    const double inertial_mps = std::sqrt(3.0) * (errors.velocity_mps + errors.attitude_rad * 5500.0);
    const double attitude_rad =
        std::sqrt(3.0) * errors.attitude_rad + 1e-3;  // and 6e-4 on each axis by the gyros' noise
    const Sclk radar_settled = *[&] {
        auto recorded = RecordedLanding::with(tests::shipped_dictionary());
        for (const auto& packet : dispersed().packets) recorded->add(packet);
        return recorded->reported("RADAR_LOCK");
    }() + 15.0;
    std::size_t compared = 0;
    for (const PathPoint& point : path->points) {
        if (!point.navigated) continue;
        ++compared;
        const NavigatedState& said = *point.navigated;
        const double apart_mps = (said.v_MB_M - point.state.v_MB_M).norm();
        CHECK(said.q_MB.angularDistance(point.state.q_MB) < sigmas_max * attitude_rad);
        if (point.at < radar_settled) {
            CHECK(apart_mps < sigmas_max * inertial_mps);
            continue;
        }
        // Then by the radar, of which it takes the mean of five seconds.
        CHECK(apart_mps < 1.0);
        const double altitude_m = point.state.p_MoB_M.norm() - path->target_radius_m;
        CHECK(std::abs(said.p_MoB_M.norm() - point.state.p_MoB_M.norm()) <
              height_at_end_max_m + sigmas_max * errors.radar_range_fraction * altitude_m);
    }
    CHECK(compared > 8 * 430);
}

TEST_CASE("a path goes over lost packets: few readings are filled, and after a gap it goes on from navigation",
          "[reconstruction][R52]") {
    std::size_t tables = 0;
    const auto without = [&](std::size_t first, std::size_t count) {
        tables = 0;
        return rebuilt(dispersed(), {}, [&, first, count](const std::vector<std::uint8_t>& packet) {
            return !is(packet, "ImuTable") || tables++ - first >= count;
        });
    };
    constexpr std::size_t in_entry = 25 * 700;  // 700 s after separation
    const auto one_lost = without(in_entry, 1);
    REQUIRE(one_lost);
    CHECK(one_lost->readings_filled == 8);
    CHECK(one_lost->breaks == 0);
    check_bounds(*one_lost, dispersed());

    const auto two_seconds_lost = without(in_entry, 50);
    REQUIRE(two_seconds_lost);
    CHECK(two_seconds_lost->breaks == 1);
    check_bounds(*two_seconds_lost, dispersed());
}

TEST_CASE("over a silence of the IMU a path claims no more than it knows", "[reconstruction][faults][R52][release]") {
    for (const std::uint64_t seed : {1U, 2U, 5U}) {
        auto scenario = tests::gale_scenario(900.0);
        auto& silence = scenario.device_faults.emplace_back();
        silence.device = flight::Device::imu;
        silence.unit = flight::Unit::a;
        silence.kind = simulation::DeviceFault::Kind::silent;
        silence.begin_before_entry_s = -245.0;
        silence.duration_s = 0.5;
        const Flown flown{scenario, seed};
        const auto path = rebuilt(flown);
        REQUIRE(path);
        INFO("seed " << seed);
        CHECK(path->breaks == 1);
        check_claims(*path, flown);
        // Flight believes in its attitude less, and nothing narrows that.
        CHECK(path->points.back().sigma_angle_rad.norm() > 2.0 * SensorErrors{}.attitude_rad);
        CHECK(path->beams_refused < path->beams_taken / 100);
    }
}

TEST_CASE("a landing that Second Chance took over is rebuilt, too, and claims no more than it knows",
          "[reconstruction][second_chance][R33][R52]") {
    const Flown flown{tests::gale_scenario(900.0), 1, 100.0};
    const auto path = rebuilt(flown);
    REQUIRE(path);
    CHECK(path->breaks == 1);
    check_claims(*path, flown);
}

TEST_CASE("packets in any order and any number of times make the same path", "[reconstruction][R52]") {
    const auto once = rebuilt(dispersed());
    auto recorded = RecordedLanding::with(tests::shipped_dictionary());
    for (auto packet = dispersed().packets.rbegin(); packet != dispersed().packets.rend(); ++packet) {
        recorded->add(*packet);
        if (packet->back() % 7 == 0) recorded->add(*packet);
    }
    const auto again = reconstruct(*recorded);
    REQUIRE(once);
    REQUIRE(again);
    REQUIRE(again->points.size() == once->points.size());
    CHECK(again->points.back().state.p_MoB_M == once->points.back().state.p_MoB_M);
    CHECK(again->points.front().state.q_MB.coeffs() == once->points.front().state.q_MB.coeffs());
}

TEST_CASE("a recording without parameters, readings or navigated states makes no path, and the reason is told",
          "[reconstruction][R52]") {
    const auto reason = [&](const char* missing) {
        const auto path = rebuilt(dispersed(), {}, [&](const auto& packet) { return !is(packet, missing); });
        return path ? std::string{} : path.error().message;
    };
    CHECK(reason("ParametersHeld") == "the recording holds no parameters");
    CHECK(reason("ImuTable") == "the recording holds no readings of the IMU");
    CHECK(reason("GncNavigation") == "the recording holds no navigated state from 30 s before entry on");
    // Without the radar the path is inertial: its height is worth as little as its attitude.
    const auto inertial = rebuilt(dispersed(), {}, [&](const auto& packet) { return !is(packet, "RadarTable"); });
    REQUIRE(inertial);
    CHECK(inertial->beams_taken == 0);
    CHECK(inertial->points.back().sigma_v_mps.norm() > 5.0);
    CHECK(worst_of(*inertial, dispersed()).v_sigmas < sigmas_max);
}

TEST_CASE("where the rover stands makes the whole path known to tens of metres, and the truth lies within it",
          "[reconstruction][R52]") {
    const auto path = rebuilt(dispersed(), {}, {}, dispersed().site);
    REQUIRE(path);
    check_claims(*path, dispersed());
    const Worst all = worst_of(*path, dispersed());
    const Worst without = worst_of(*rebuilt(dispersed()), dispersed());
    CHECK(all.p_m < without.p_m / 3.0);
    CHECK(path->points.back().sigma_p_m.norm() < 2.0 * std::sqrt(3.0) * LandingSite{}.sigma_m);
    for (const PathPoint& point : path->points)
        if (point.at - path->entry > 200.0) CHECK(point.sigma_p_m.norm() < 60.0);
}

TEST_CASE("a landing site that the path cannot have come to is refused with how far it is", "[reconstruction][R52]") {
    auto elsewhere = *dispersed().site;
    elsewhere.longitude_deg += 1.0;
    const auto path = rebuilt(dispersed(), {}, {}, elsewhere);
    REQUIRE_FALSE(path);
    CHECK_THAT(path.error().message,
               Catch::Contains("the landing site is 59.") && Catch::Contains("km from where the path ends, "));
    const auto flying = rebuilt(
        dispersed(), {},
        [&](const auto& packet) {
            return Apid{static_cast<std::uint16_t>(read_bits(packet, 5, 11))} !=
                   tests::shipped_dictionary().packet("TOUCHDOWN")->apid;
        },
        dispersed().site);
    REQUIRE_FALSE(flying);
    CHECK(flying.error().message == "no touchdown was reported: a landing site says nothing of this path");
}

}  // namespace server_reconstruction_path_test
