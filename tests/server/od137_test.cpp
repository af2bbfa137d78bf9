// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal.hpp"
#include "simulation/landing.hpp"
#include "tests/server/running_server.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace server_od137_test {

using namespace aeolis;
using namespace aeolis::server;
using simulation::TruthState;

namespace {

/// One landing of the scenario, by the whole flight software, with the truth of each tick.
struct Flown {
    std::map<std::string, simulation::TruthEvent> events;
    std::vector<TruthState> truth;  ///< 16 a second, as the published trajectory has them
    TruthState first_drag;          ///< at 0.2 g, unfiltered
    double peak_mps2 = 0.0;
    simulation::TouchdownReport touchdown;

    Flown() {
        Rehearsal rehearsal{test::shipped_scenario("od137"), 1, 0, tests::shipped_dictionary()};
        while (rehearsal.landing().outcome() == simulation::Outcome::running) {
            rehearsal.step();
            const TruthState now = rehearsal.landing().truth();
            if (now.e_s < 0.0) continue;
            if (first_drag.sensed_mps2 == 0.0 && now.sensed_mps2 >= 1.96) first_drag = now;
            if (now.sclk.ticks() % 4 == 0) truth.push_back(now);
        }
        REQUIRE(rehearsal.outcome() == archive::Outcome::touchdown);
        for (const auto& event : rehearsal.events()) events.emplace(event.name, event);
        peak_mps2 = rehearsal.landing().peak_deceleration_mps2();
        touchdown = *rehearsal.landing().touchdown();
    }
};

const Flown& flown() {
    static const Flown once;
    return once;
}

/// A row of od137_events.csv.
struct Published {
    std::string event;
    double e_s, height_m, speed_mps, within_s, speed_within;
};

std::vector<double> numbers_of(const std::string& line, std::size_t first_column) {
    std::vector<double> numbers;
    std::istringstream cells{line};
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column)
        if (column >= first_column) numbers.push_back(std::stod(cell));
    return numbers;
}

std::vector<Published> published_events() {
    std::ifstream file{AEOLIS_SOURCE_DIR "/tests/simulation/od137_events.csv"};
    REQUIRE(file);
    std::vector<Published> events;
    for (std::string line; std::getline(file, line);) {
        if (line[0] == '#' || line.rfind("event,", 0) == 0) continue;
        const std::vector<double> row = numbers_of(line, 1);
        REQUIRE(row.size() == 5);
        events.push_back({line.substr(0, line.find(',')), row[0], row[1], row[2], row[3], row[4]});
    }
    return events;
}

}  // namespace

TEST_CASE("OD137's events come at its times, heights and speeds, flown from its entry state", "[od137][R27]") {
    const auto published_all = published_events();
    REQUIRE(published_all.size() == 13);
    for (const Published& published : published_all) {
        REQUIRE(flown().events.count(published.event) == 1);
        const auto& event = flown().events.at(published.event);
        const double height_m =
            event.altitude_m;  // the scenario's ground lies where the stage's height is nil at touchdown
        INFO(published.event << ": E+" << event.e_s << " (" << published.e_s << "), " << height_m << " m ("
                             << published.height_m << "), " << event.speed_mps << " m/s (" << published.speed_mps
                             << ")");
        CHECK(std::abs(event.e_s - published.e_s) <= published.within_s);
        CHECK(std::abs(height_m - published.height_m) <= std::max(0.03 * published.height_m, 10.0));
        CHECK(std::abs(event.speed_mps - published.speed_mps) <=
              std::max(published.speed_within * published.speed_mps, 1.0));
    }
    CHECK(flown().first_drag.e_s == Approx(43.0).margin(1.5));
    CHECK(flown().peak_mps2 == Approx(121.10).epsilon(0.03));
}

TEST_CASE("OD137's powered descent takes as long in each of its parts, and ends as softly", "[od137][R27]") {
    const auto lasts = [](const char* from, const char* to) {
        return flown().events.at(to).e_s - flown().events.at(from).e_s;
    };
    CHECK(lasts("powered_approach_start", "constant_velocity_start") == Approx(18.6).epsilon(0.05));
    CHECK(lasts("constant_velocity_start", "constant_deceleration_start") == Approx(3.2).epsilon(0.05));
    CHECK(lasts("constant_deceleration_start", "sky_crane_start") == Approx(7.3).epsilon(0.05));
    CHECK(flown().touchdown.vertical_mps == Approx(0.75).margin(0.05));
    CHECK(flown().touchdown.horizontal_mps <= 0.2);
}

TEST_CASE("OD137's trajectory is followed from entry to SUFR: height within 400 m RMS, speed within 30 m/s",
          "[od137][R27]") {
    std::ifstream file{AEOLIS_SOURCE_DIR "/../shared/data/od137_trajectory.csv"};
    if (!file) {
        std::printf("SKIPPED: the published trajectory is not beside the project (../shared/data)\n");
        return;
    }
    double height2 = 0.0, speed2 = 0.0;
    int count = 0;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#' || line[0] == 'e') continue;
        const std::vector<double> cells = numbers_of(line, 0);
        const double e_s = cells[1];
        if (e_s < 0.0 || e_s > 250.0) continue;
        const auto& all = flown().truth;
        const auto after = std::lower_bound(all.begin(), all.end(), e_s,
                                            [](const TruthState& t, double at_s) { return t.e_s < at_s; });
        if (after == all.begin() || after == all.end()) continue;
        const TruthState& b = *after;
        const TruthState& a = *(after - 1);
        const double part = (e_s - a.e_s) / (b.e_s - a.e_s);
        height2 += std::pow(a.altitude_m + part * (b.altitude_m - a.altitude_m) - cells[3] * 1000.0, 2);
        speed2 += std::pow(a.speed_mps + part * (b.speed_mps - a.speed_mps) - cells[7], 2);
        ++count;
    }
    REQUIRE(count > 200);
    INFO("RMS of height " << std::sqrt(height2 / count) << " m, of speed " << std::sqrt(speed2 / count) << " m/s over "
                          << count << " points");
    CHECK(std::sqrt(height2 / count) <= 400.0);
    CHECK(std::sqrt(speed2 / count) <= 30.0);
}

}  // namespace server_od137_test
