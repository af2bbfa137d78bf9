// SPDX-License-Identifier: Apache-2.0
// The day after: path and air of landings by their recordings and the place where the rover stands, against the truth.
#include "server/reconstruction/density.hpp"

#include "tests/server/reconstruction/flown_landing.hpp"
#include "tests/simulation/gale.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace server_reconstruction_density_test {

using namespace aeolis;
using namespace aeolis::reconstruction;
using tests::Flown;

namespace {

/// How many samples of a quantity lie within three of their own standard deviations of the truth.
struct Consistency {
    std::uint64_t within = 0, samples = 0;
    double squares = 0.0;  ///< of the errors in standard deviations

    void add(double error, double sigma) {
        constexpr double sigmas = 3.0;
        ++samples;
        if (std::abs(error) <= sigmas * sigma) ++within;
        squares += (error / sigma) * (error / sigma);
    }
    double fraction() const { return static_cast<double>(within) / static_cast<double>(samples); }
    double rms_sigmas() const { return std::sqrt(squares / static_cast<double>(samples)); }
};
using Consistencies = std::map<std::string, Consistency>;

void compare(const Flown& flown, Consistencies& all) {
    const auto recorded = tests::recorded_of(flown);
    const auto path = reconstruct(recorded, {}, flown.site);
    REQUIRE(path);
    for (const PathPoint& point : path->points) {
        const auto truth = flown.true_at(point.at);
        if (!truth) continue;
        const Vector3 p_m = point.state.p_MoB_M - truth->p_MoB_M, v_mps = point.state.v_MB_M - truth->v_MB_M;
        const Eigen::AngleAxisd turn{point.state.q_MB * truth->q_MB.conjugate()};
        const Vector3 angle_rad = turn.angle() * turn.axis();
        for (int axis = 0; axis < 3; ++axis) {
            all["position"].add(p_m[axis], point.sigma_p_m[axis]);
            all["velocity"].add(v_mps[axis], point.sigma_v_mps[axis]);
            all["attitude"].add(angle_rad[axis], point.sigma_angle_rad[axis]);
        }
        all["height"].add(point.state.p_MoB_M.norm() - truth->p_MoB_M.norm(), point.sigma_height_m);
    }
    for (const DensityPoint& point : density_along(*path, recorded)) {
        const auto truth = flown.density_at_kgm3(point.at);
        if (truth) all["density"].add(point.density_kgm3 - *truth, point.sigma_kgm3);
    }
}

void check_consistent(const Consistencies& all) {
    CHECK(all.size() == 5);
    for (const auto& [quantity, one] : all) {
        INFO(quantity << ": " << one.within << " of " << one.samples << " within 3 sigma, rms " << one.rms_sigmas());
        CHECK(one.samples > 1000);
        CHECK(one.fraction() >= 0.95);
    }
}

}  // namespace

TEST_CASE("a nominal landing and two others are rebuilt consistently with their own three sigmas in 95 % of samples",
          "[reconstruction][R52]") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        INFO("seed " << seed);
        Consistencies one;
        compare(Flown{tests::gale_scenario(900.0), seed}, one);
        check_consistent(one);
    }
}

TEST_CASE("ten dispersed landings are rebuilt consistently, and their sigmas are no wider than their errors ask for",
          "[reconstruction][R52][.long]") {
    Consistencies all;
    for (std::uint64_t seed = 11; seed <= 20; ++seed) {
        INFO("seed " << seed);
        Consistencies one;
        const Flown flown{tests::gale_scenario(900.0), seed};
        compare(flown, one);
        check_consistent(one);
        compare(flown, all);
    }
    for (const auto& [quantity, one] : all) {
        INFO(quantity << ": rms " << one.rms_sigmas());
        CHECK(one.rms_sigmas() > 0.2);
        CHECK(one.rms_sigmas() < 1.4);
    }
}

TEST_CASE("without errors of vehicle, air and sensors the density is that of the scenario's air to a percent",
          "[reconstruction][R52]") {
    const Flown flown{tests::undisturbed_scenario(900.0), 1};
    const auto recorded = tests::recorded_of(flown);
    const auto path = reconstruct(recorded, {}, flown.site);
    REQUIRE(path);
    const auto density = density_along(*path, recorded);
    REQUIRE(density.size() > 1000);
    CHECK(density.front().altitude_m > 80'000.0);
    CHECK(density.back().altitude_m < 12'500.0);
    for (const DensityPoint& point : density) {
        if (point.altitude_m > 65'000.0) continue;  // there the IMU's noise is felt
        const double true_kgm3 = *flown.density_at_kgm3(point.at);
        INFO(point.altitude_m << " m, Mach " << point.mach);
        CHECK(point.density_kgm3 == Approx(true_kgm3).epsilon(0.01));
    }
    CHECK(recorded.balance_pairs_gone().size() == 3);
    CHECK(density.back().at < *recorded.reported("PARACHUTE_DEPLOY"));
    CHECK(density.back().at - path->entry > 240.0);

    // A vehicle of other mass and drag than the design's is judged by its own.
    const KnownVehicle heavier{2.0 * 3153.0, 50.0, {{4.0, 1.0}, {6.0, 1.25}}};
    const auto judged = density_along(*path, recorded, heavier);
    for (const auto& [mach, times] : {std::pair{20.0, 2.0 / 1.25}, {5.0, 2.0 / 1.125}, {3.0, 2.0}}) {
        const auto at = std::ranges::lower_bound(density, -mach, {}, [](const auto& point) { return -point.mach; });
        const auto same = std::ranges::find(judged, at->at, &DensityPoint::at);
        REQUIRE(same != judged.end());
        CHECK(same->density_kgm3 == Approx(times * at->density_kgm3).epsilon(0.01));
    }

    // Without the word that the parachute was deployed: only where it cannot be out, with the same values.
    const auto event = tests::shipped_dictionary().event("PARACHUTE_DEPLOY")->id;
    const auto untold = tests::recorded_of(flown, [&](const auto& packet) {
        const auto read = read_tm_packet(packet);
        return !read || read->primary.apid != flight::evr::PARACHUTE_DEPLOY::apid ||
               read_bits(packet, tm_data_offset_octets * 8, 16) != event.value;
    });
    REQUIRE_FALSE(untold.reported("PARACHUTE_DEPLOY"));
    const auto shorter = density_along(*path, untold);
    REQUIRE(shorter.size() > 1000);
    CHECK(shorter.size() < density.size());
    CHECK(shorter.back().mach >= 2.3);
    CHECK(shorter.back().density_kgm3 == density.at(shorter.size() - 1).density_kgm3);
}

}  // namespace server_reconstruction_density_test
