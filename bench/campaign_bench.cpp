// SPDX-License-Identifier: Apache-2.0
// Measures a campaign case against its dynamics: one thread, the same cases, the same stretch of flight.
//
//   case       copied at the moment of dispersion, flown to its end by the whole flight software, as in `aeolis
//              campaign`
//   dynamics   the world alone over that stretch, flown by the stand-in for flight software in tests/simulation
//   goal       cases at 0.4 of the rate of their dynamics; 8001 cases in 30 minutes on 2 processors
#include "server/campaign/case_flights.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/simulation/truth_pilot.hpp"

#include <cstdio>
#include <ctime>

namespace {

using namespace aeolis;

constexpr std::uint64_t cases = 24;
constexpr double rate_goal = 0.4;
constexpr double case_goal_s = 30.0 * 60.0 * 2.0 / 8001.0;

/// Processor time, so that other processes do not count.
double now_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

int main() {
    const auto scenario = server::scenario_from_file(AEOLIS_SOURCE_DIR "/simulation/scenarios/campaign.textproto");
    const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!scenario || !loaded.dictionary) return 1;
    const server::campaign::CaseFlights flights{*scenario, 1, *loaded.dictionary};
    tests::TruthPilot trunk{*scenario, 1};
    trunk.run_until(-*scenario->disperse_before_entry_s);

    // In turn, so that a slowing processor slows both alike.
    double case_s = 0.0, dynamics_s = 0.0;
    std::uint64_t landed = 0;
    for (std::uint64_t number = 1; number <= cases; ++number) {
        const double began_s = now_s();
        landed += flights.fly(number)->outcome == "touchdown" ? 1 : 0;
        const double flown_s = now_s();
        tests::TruthPilot pilot{trunk};
        (void)pilot.world.disperse(1, number);
        pilot.run();
        case_s += flown_s - began_s;
        dynamics_s += now_s() - flown_s;
    }
    const auto each = static_cast<double>(cases);
    const double ratio = dynamics_s / case_s;
    std::printf("%llu cases, %llu landed\n", static_cast<unsigned long long>(cases),
                static_cast<unsigned long long>(landed));
    std::printf("a case %.3f s, its dynamics alone %.3f s: rate %.2f of theirs, goal %.2f, ratio %.2f\n", case_s / each,
                dynamics_s / each, ratio, rate_goal, ratio / rate_goal);
    std::printf("8001 cases on 2 processors: %.1f min, goal 30 min, ratio %.2f\n", 8001.0 * case_s / each / 2.0 / 60.0,
                case_s / each / case_goal_s);
    return ratio >= rate_goal && case_s / each <= case_goal_s ? 0 : 1;
}
