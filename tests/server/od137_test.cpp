#include "server/rehearsal/rehearsal.hpp"
#include "simulation/landing.hpp"
#include "tests/server/running_server.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

using namespace aeolis;
using namespace aeolis::server;
using simulation::TruthState;

namespace {

/// One landing of the scenario, by the whole flight software, with the truth of each tick.
struct Flown {
    std::map<std::string, simulation::TruthEvent> events;
    std::vector<TruthState> truth; ///< 16 a second, as the published trajectory has them
    TruthState first_drag;         ///< at 0.2 g, unfiltered
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
        REQUIRE(rehearsal.outcome() == "touchdown");
        for (const auto& event : rehearsal.events())
            events.emplace(event.name, event);
        peak_mps2 = rehearsal.landing().peak_deceleration_mps2();
        touchdown = *rehearsal.landing().touchdown();
    }
};

const Flown& flown() {
    static const Flown once;
    return once;
}

/// [facts] Timeline of OD137, events with a published time. Height counts from the stage's at touchdown.
struct Published {
    const char* event;
    double e_s, height_m, speed_mps;
};
constexpr Published timeline[] = {
    {"bank_reversal_1", 78.0, 27500, 4398},     {"bank_reversal_2", 98.0, 19500, 2415},
    {"bank_reversal_3", 127.0, 17900, 1275},    {"peak_deceleration", 79.35, 26650, 4239},
    {"sufr_start", 239.0, 14100, 453},          {"parachute_deploy", 255.9, 11900, 404.6},
    {"heatshield_separation", 277.35, 9890, 142}, {"backshell_separation", 374.97, 1662, 79.1},
    {"powered_approach_start", 378.2, 1380, 90.5}, {"constant_velocity_start", 396.8, 235, 32.0},
    {"constant_deceleration_start", 400.0, 133, 32.0}, {"sky_crane_start", 407.3, 18, 0.75},
};

} // namespace

TEST_CASE("OD137's events come at its times, heights and speeds, flown from its entry state", "[od137][R27]") {
    const double stage_m = flown().events.at("touchdown").altitude_m;
    bool late = false, slow = false;
    for (const Published& published : timeline) {
        REQUIRE(flown().events.count(published.event) == 1);
        const auto& event = flown().events.at(published.event);
        late = late || std::string{published.event} == "backshell_separation";
        slow = slow || std::string{published.event} == "heatshield_separation";
        const double height_m = event.altitude_m - stage_m;
        INFO(published.event << ": E+" << event.e_s << " (" << published.e_s << "), " << height_m << " m ("
                             << published.height_m << "), " << event.speed_mps << " m/s (" << published.speed_mps << ")");
        CHECK(std::abs(event.e_s - published.e_s) <= (late ? 2.5 : 1.5));
        CHECK(std::abs(height_m - published.height_m) <= std::max(0.03 * published.height_m, 10.0));
        CHECK(std::abs(event.speed_mps - published.speed_mps) <= std::max((slow ? 0.04 : 0.02) * published.speed_mps, 1.0));
    }
    CHECK(flown().first_drag.e_s == Approx(43.0).margin(1.5));
    CHECK(flown().events.at("touchdown").e_s == Approx(431.47).margin(2.5));
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
        std::vector<double> cells;
        std::istringstream row{line};
        for (std::string cell; std::getline(row, cell, ',');)
            cells.push_back(std::stod(cell));
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
