// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/radar_batch.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_radar_batch_test {

using namespace aeolis;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

/// Six beams, one straight down, over flat ground: what a perfect radar measures.
FixedVector<flight::RadarBeam, 6> beams_of(double altitude_m, const Vector3& v_M, const Quaternion& q_MB,
                                           const Vector3& up_M) {
    FixedVector<flight::RadarBeam, 6> beams;
    for (std::uint8_t i = 0; i < 6; ++i) {
        const double off = i == 0 ? 0.0 : i < 4 ? 20.0 * degree : 50.0 * degree;
        const double around = 2.0 * i;
        const Vector3 d_B(std::sin(off) * std::cos(around), std::sin(off) * std::sin(around), std::cos(off));
        const Vector3 d_M = q_MB * d_B;
        beams.push_back({i, to_array(d_B), true, altitude_m / -d_M.dot(up_M), -d_M.dot(v_M)});
    }
    return beams;
}

const Vector3 up = Vector3::UnitX();
const Quaternion down(Eigen::AngleAxisd(-pi / 2, Vector3::UnitY()));  // z of B to −x of M

}  // namespace

TEST_CASE("a steady descent comes out exactly: altitude and velocity", "[gnc][R25]") {
    RadarBatch batch;
    REQUIRE(((down * Vector3::UnitZ()) + up).norm() < 1e-12);
    const Vector3 v(-80.0, 5.0, -3.0);
    for (int tick = 0; tick <= 64 * 8; ++tick)
        batch.on(parameters, Sclk::from_ticks(tick), beams_of(3000.0 - 80.0 * tick / 64.0, v, down, up).span(), down,
                 up);
    const auto solution = batch.solve(parameters, Sclk{8.0});
    REQUIRE(solution);
    CHECK((to_vector(solution->v_MB_M_mps) - v).norm() < 1e-9);
    CHECK(solution->altitude_m == Approx(3000.0 - 80.0 * solution->time.seconds).epsilon(1e-9));
    CHECK(solution->span_s == Approx(4.75).margin(0.02));
    CHECK(solution->time.seconds == Approx(8.0 - 2.375).margin(0.02));
}

TEST_CASE("no beams, one beam or lost beams give no solution", "[gnc][R25]") {
    RadarBatch batch;
    CHECK_FALSE(batch.solve(parameters, Sclk{1.0}));
    for (int tick = 0; tick < 128; ++tick) {
        auto beams = beams_of(1000.0, Vector3::Zero(), down, up);
        for (std::size_t i = 1; i < beams.size(); ++i) beams[i].valid = false;
        batch.on(parameters, Sclk::from_ticks(tick), beams.span(), down, up);
    }
    CHECK_FALSE(batch.solve(parameters, Sclk{2.0}));
}

TEST_CASE("what is older than five seconds is forgotten", "[gnc][R25]") {
    RadarBatch batch;
    for (int tick = 0; tick < 64; ++tick)
        batch.on(parameters, Sclk::from_ticks(tick), beams_of(1000.0, Vector3::Zero(), down, up).span(), down, up);
    CHECK(batch.solve(parameters, Sclk{1.0}));
    CHECK(batch.solve(parameters, Sclk{5.5}));
    CHECK_FALSE(batch.solve(parameters, Sclk{6.0}));
}

}  // namespace flight_gnc_radar_batch_test
