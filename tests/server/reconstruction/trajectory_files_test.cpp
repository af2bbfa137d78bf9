// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/trajectory_files.hpp"

#include "common/ck.hpp"
#include "common/navigation_message.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <fstream>
#include <iterator>

namespace server_reconstruction_trajectory_files_test {

using namespace aeolis;
using namespace aeolis::reconstruction;

namespace {

constexpr ClockCorrelation clock{Sclk{397501000.0}, Scet{397501847'400'000}, 1.0 + 1e-7, 35, 1};

/// A fall from 130 km, turning about an axis that lies aslant.
std::vector<TimedState> fall() {
    std::vector<TimedState> path;
    for (int i = 0; i < 400; ++i) {
        const double t = i * 0.125;
        flight::gnc::NavigatedState state;
        const double radius_m = 3'522'800.0 - 600.0 * t, angle = 5500.0 * t / radius_m;
        state.p_MoB_M = radius_m * flight::gnc::Vector3(std::cos(angle), std::sin(angle), 0.0);
        state.v_MB_M = flight::gnc::Vector3(-600.0 * std::cos(angle) - 5500.0 * std::sin(angle),
                                            -600.0 * std::sin(angle) + 5500.0 * std::cos(angle), 0.0);
        state.q_MB = Eigen::AngleAxisd(0.1 * t, flight::gnc::Vector3(1.0, 2.0, -0.5).normalized());
        path.push_back({clock.sclk + t, state});
    }
    return path;
}

std::vector<std::uint8_t> octets_of(const std::string& text) {
    return {text.begin(), text.end()};
}

}  // namespace

TEST_CASE("a path that left as OEM or SPK comes back as it was flown, to a millimetre", "[reconstruction][spice]") {
    const auto path = fall();
    for (const auto format : {TrajectoryFormat::oem, TrajectoryFormat::spk}) {
        const auto file = trajectory_file(format, path, clock, Scet{});
        REQUIRE(file.ok());
        const auto read = ForeignTrajectory::read(octets_of(*file));
        REQUIRE(read.ok());
        for (const TimedState& point : path) {
            const auto there = read->at(ephemeris_time_of(clock.scet_of(point.at)));
            // The first and last instant may lie a microsecond beyond, by rounding.
            if (!there && (point.at == path.front().at || point.at == path.back().at)) continue;
            REQUIRE(there);
            const Residual off = residual_of(point.state, *there);
            // An OEM's instants are whole microseconds, in which it moves 6 mm.
            CHECK(std::hypot(off.up_m, off.along_m, off.right_m) < (format == TrajectoryFormat::oem ? 0.01 : 0.001));
            CHECK(std::abs(off.speed_mps) < 1e-4);
        }
        // It comes down to 3522.2 km a second after its beginning.
        const auto entry = read->reaches(3'522'200.0);
        REQUIRE(entry);
        CHECK(std::abs(*entry - ephemeris_time_of(clock.scet_of(path.front().at)) - 1.0) < 1e-3);
    }
    CHECK_FALSE(trajectory_file(TrajectoryFormat::oem, std::span{path}.first(3), clock, Scet{}).ok());
}

TEST_CASE("AEM and CK say the same attitude, that which turns J2000 into the vehicle's axes",
          "[reconstruction][spice]") {
    const auto path = fall();
    const auto aem = trajectory_file(TrajectoryFormat::aem, path, clock, Scet{});
    const auto ck = trajectory_file(TrajectoryFormat::ck, path, clock, Scet{});
    REQUIRE((aem.ok() && ck.ok()));
    const auto history = read_attitude_message(*aem);
    const auto segments = read_ck(octets_of(*ck));
    REQUIRE((history.ok() && segments.ok()));
    REQUIRE(history->front().states.size() == path.size());
    REQUIRE(segments->front().pointings.size() == path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
        const auto& a = history->front().states[i].q_BA;
        const auto& b = segments->front().pointings[i].q_BA;
        double cosine = 0.0;
        for (std::size_t k = 0; k < 4; ++k) cosine += a.at(k) * b.at(k);
        CHECK(std::abs(std::abs(cosine) - 1.0) < 1e-9);
        CHECK(segments->front().pointings[i].sclk_ticks == path[i].at.seconds * ck_ticks_per_s);
    }
}

TEST_CASE("residuals lie up, along the track and to its right, and are of the flown less the other",
          "[reconstruction]") {
    ForeignTrajectory::State other;
    other.p_MoB_M_m = {3'400'000.0, 0.0, 0.0};
    other.v_MB_M_mps = {-50.0, 100.0, 0.0};  // down, and east
    flight::gnc::NavigatedState flown;
    flown.p_MoB_M = {3'400'010.0, 20.0, -30.0};  // 10 m higher, 20 m east, 30 m south
    flown.v_MB_M = {-50.0, 100.0, 0.0};
    const Residual off = residual_of(flown, other);
    CHECK(off.up_m == Approx(10.0));
    CHECK(off.along_m == Approx(20.0));
    CHECK(off.right_m == Approx(30.0));
    CHECK(off.speed_mps == Approx(0.0).margin(1e-12));
}

TEST_CASE("a file of another body, centre or frame is refused with what it holds", "[reconstruction][spice]") {
    const auto file = trajectory_file(TrajectoryFormat::oem, fall(), clock, Scet{});
    REQUIRE(file.ok());
    const auto refusal = [&](const std::string& from, const std::string& to) {
        std::string text = *file;
        text.replace(text.find(from), from.size(), to);
        const auto read = ForeignTrajectory::read(octets_of(text));
        return read ? "read" : read.error().message;
    };
    CHECK_THAT(refusal("= MARS", "= EARTH"), Catch::Contains("MSL about EARTH in EME2000"));
    CHECK_THAT(refusal("= EME2000", "= TEME"), Catch::Contains("MSL about MARS in TEME"));
    CHECK_THAT(ForeignTrajectory::read(octets_of("e_s,sclk\n")).error().message, Catch::Contains("line 1"));
}

TEST_CASE("the published trajectory of 2012 comes down to entry interface when it says so", "[reconstruction][spice]") {
    std::ifstream from{AEOLIS_SOURCE_DIR "/../shared/data/od137.bsp", std::ios::binary};
    if (!from)
        return void(std::printf("SKIPPED: the published trajectory is not beside the project (../shared/data)\n"));
    const std::vector<std::uint8_t> octets{std::istreambuf_iterator<char>{from}, {}};
    const auto read = ForeignTrajectory::read(octets);
    REQUIRE(read.ok());
    const auto entry = read->reaches(3'522'200.0);
    REQUIRE(entry);
    CHECK(std::abs(entry->seconds - (397501364.5942 + 549.965466)) < 0.01);  // of od137_trajectory.csv
}

}  // namespace server_reconstruction_trajectory_files_test
