// SPDX-License-Identifier: Apache-2.0
#include "common/spk.hpp"

#include "common/ck.hpp"
#include "common/mars_orientation.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <sstream>

namespace common_spk_test {

using namespace aeolis;

namespace {

std::vector<std::uint8_t> octets_of(const std::filesystem::path& file) {
    std::ifstream from{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{from}, {}};
}

SpkSegment segment_of(std::size_t count, Interpolation interpolation, std::size_t degree) {
    SpkSegment segment{"a fall", spice_msl, spice_mars, spice_j2000, 0, {}};
    for (std::size_t i = 0; i < count; ++i) {
        const double t = 4e8 + 0.125 * static_cast<double>(i) + 1e-3 * static_cast<double>(i % 7);
        segment.ephemeris.states.push_back({{t}, {3500.0 - t * 1e-7, t, 1.5}, {-0.25, 5.5, 1e-9 * t}});
    }
    segment.ephemeris.interpolation = interpolation;
    segment.ephemeris.degree = degree;
    segment.ephemeris.start = segment.ephemeris.states.front().time;
    segment.ephemeris.stop = segment.ephemeris.states.back().time;
    return segment;
}

/// The same file as a machine of the other order of octets writes it.
std::vector<std::uint8_t> turned(std::vector<std::uint8_t> file) {
    const auto turn = [&](std::size_t at, std::size_t octets) {
        std::reverse(file.begin() + static_cast<std::ptrdiff_t>(at),
                     file.begin() + static_cast<std::ptrdiff_t>(at + octets));
    };
    for (const std::size_t at : {8U, 12U, 76U, 80U, 84U}) turn(at, 4);
    file[88] = 'B', file[89] = 'I', file[90] = 'G';
    for (std::size_t at = 1024; at < 2048; at += 8) {
        const std::size_t of_summary = (at - 1024) / 8;
        const bool integers = of_summary >= 3 && (of_summary - 3) % 5 >= 2;
        if (integers)
            turn(at, 4), turn(at + 4, 4);
        else
            turn(at, 8);
    }
    for (std::size_t at = 3072; at < file.size(); at += 8) turn(at, 8);
    return file;
}

}  // namespace

TEST_CASE("a trajectory kernel is read as it was written, bit for bit, in either order of octets", "[spice]") {
    for (const auto& [count, interpolation, degree] : {std::tuple{8UL, Interpolation::hermite, 7UL},
                                                       {100UL, Interpolation::hermite, 3UL},
                                                       {101UL, Interpolation::lagrange, 8UL},
                                                       {1'234UL, Interpolation::lagrange, 1UL}}) {
        CAPTURE(count, degree);
        const std::vector wanted{segment_of(count, interpolation, degree), segment_of(40, Interpolation::hermite, 7)};
        const auto file = write_spk(wanted, "aeolis");
        REQUIRE(file.ok());
        CHECK(file->size() % 1024 == 0);
        for (const auto& octets : {*file, turned(*file)}) {
            const auto read = read_spk(octets);
            REQUIRE(read.ok());
            REQUIRE(read->size() == 2);
            const SpkSegment& first = read->front();
            CHECK(first.name == "a fall");
            CHECK(first.body == spice_msl);
            CHECK(first.centre == spice_mars);
            CHECK(first.type == (interpolation == Interpolation::hermite ? 13 : 9));
            CHECK(first.ephemeris.degree == degree);
            REQUIRE(first.ephemeris.states.size() == count);
            for (std::size_t i = 0; i < count; ++i) {
                CHECK(first.ephemeris.states[i].time == wanted[0].ephemeris.states[i].time);
                CHECK(first.ephemeris.states[i].position_km == wanted[0].ephemeris.states[i].position_km);
                CHECK(first.ephemeris.states[i].velocity_kmps == wanted[0].ephemeris.states[i].velocity_kmps);
            }
        }
    }
}

TEST_CASE("the published kernel of 2012 is the published table, and turned to Mars its latitudes", "[spice][frames]") {
    const std::filesystem::path folder = AEOLIS_SOURCE_DIR "/../shared/data";
    if (!std::filesystem::exists(folder / "od137.bsp")) {
        std::printf("SKIPPED: the published trajectory is not beside the project (../shared/data)\n");
        return;
    }
    const auto segments = read_spk(octets_of(folder / "od137.bsp"));
    REQUIRE(segments.ok());
    CHECK(segments->size() > 10);
    // Some of its segments are of types that are not read, and say which.
    CHECK(std::ranges::any_of(*segments, [](const auto& each) { return each.ephemeris.states.empty(); }));
    std::ifstream table{folder / "od137_trajectory.csv"};
    std::string line;
    std::getline(table, line), std::getline(table, line);
    std::size_t compared = 0;
    while (std::getline(table, line)) {
        std::istringstream row{line};
        std::vector<double> columns;
        for (std::string cell; std::getline(row, cell, ',');) columns.push_back(cell.empty() ? 0.0 : std::stod(cell));
        const EphemerisTime time{columns.at(0)};
        const auto segment = std::ranges::find_if(*segments, [&](const SpkSegment& each) {
            return each.body == spice_msl && each.centre == spice_mars && state_at(each.ephemeris, time);
        });
        if (segment == segments->end()) continue;
        const auto state = *state_at(segment->ephemeris, time);
        const auto& [x, y, z] = state.position_km;
        const double radius = std::sqrt(x * x + y * y + z * z);
        CAPTURE(columns[1]);
        CHECK(std::abs(radius - columns.at(2)) < 2e-6);  // the table has six decimals of a kilometre
        const auto& v = state.velocity_kmps;
        CHECK(std::abs(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * 1e3 - columns.at(8)) < 1e-5);
        const auto fixed = to_mars_fixed({state.position_km, state.velocity_kmps}, time);
        constexpr double degree_rad = std::numbers::pi / 180.0;
        CHECK(std::abs(std::asin(fixed.position[2] / radius) / degree_rad - columns.at(5)) < 2e-6);
        CHECK(std::abs(std::atan2(fixed.position[1], fixed.position[0]) / degree_rad - columns.at(6)) < 2e-6);
        ++compared;
    }
    CHECK(compared == 3005);  // all rows of the table
}

TEST_CASE("a kernel that was cut, spoiled or is of another kind is refused in a line", "[spice][property]") {
    const auto written = write_spk({segment_of(120, Interpolation::hermite, 7)}, "aeolis");
    REQUIRE(written.ok());
    CHECK_THAT(read_ck(*written).error().message, Catch::Contains("kind SPK, not CK"));
    CHECK_THAT(read_spk(std::vector<std::uint8_t>(5'000, 'x')).error().message, Catch::Contains("DAF/"));
    CHECK_THAT(read_spk({}).error().message, Catch::Contains("DAF/"));
    CHECK_FALSE(write_spk({}, "").ok());
    CHECK_FALSE(write_spk({segment_of(3, Interpolation::hermite, 7)}, "").ok());
    std::mt19937 random{3};
    for (int i = 0; i < 3'000; ++i) {
        auto spoiled = *written;
        if (random() % 3 == 0) spoiled.resize(random() % spoiled.size());
        const auto among = std::min<std::size_t>(spoiled.size(), random() % 2 == 0 ? 2'048 : spoiled.size());
        for (std::size_t k = 0; k < 1 + random() % 4 && among > 0; ++k)
            spoiled[random() % among] = static_cast<std::uint8_t>(random());
        const auto read = read_spk(spoiled);  // no fault of memory, and what is read has ascending times
        if (!read) continue;
        for (const auto& segment : *read)
            CHECK(std::ranges::is_sorted(segment.ephemeris.states, {},
                                         [](const auto& state) { return state.time.seconds; }));
    }
}

}  // namespace common_spk_test
