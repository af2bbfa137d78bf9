// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/targeting.hpp"

#include "server/campaign/statistics.hpp"

#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::campaign {
namespace {

/// Whole metres, and no negative zero.
double in_metres(double offset_m) {
    return std::round(offset_m) + 0.0;
}

}  // namespace

Aim aim_of(const simulation::Scenario& scenario) {
    return {in_metres(scenario.guidance.aim_east_m), in_metres(scenario.guidance.aim_north_m)};
}

simulation::Scenario with_aim(const simulation::Scenario& scenario, const Aim& aim) {
    simulation::Scenario aimed = scenario;
    aimed.guidance.aim_east_m = aim.east_m;
    aimed.guidance.aim_north_m = aim.north_m;
    aimed.name += fmt::format("-aim-{:.0f}e-{:.0f}n", aim.east_m, aim.north_m);
    return aimed;
}

double AimedLandings::miss_m() const {
    return std::hypot(east_m, north_m);
}

Result<AimedLandings> aimed_landings(const Aim& aim, const CaseTable& table) {
    const CaseTable::Column* east = table.column("east_m");
    const CaseTable::Column* north = table.column("north_m");
    AimedLandings landings;
    landings.aim = aim;
    landings.cases = table.numbers.size();
    Moments easts, norths;
    for (std::size_t i = 0; east != nullptr && north != nullptr && i < east->values.size(); ++i) {
        if (std::isnan(east->values[i]) || std::isnan(north->values[i])) continue;
        easts.add(east->values[i]);
        norths.add(north->values[i]);
        ++landings.landed;
    }
    if (landings.landed < 2)
        return Error{fmt::format("{} of {} cases landed by an aim of {:.0f} m east and {:.0f} m north: no mean of "
                                 "their places",
                                 landings.landed, landings.cases, aim.east_m, aim.north_m)};
    const double by_root = 1.0 / std::sqrt(static_cast<double>(landings.landed));
    landings.east_m = easts.mean();
    landings.north_m = norths.mean();
    landings.east_sigma_m = easts.deviation() * by_root;
    landings.north_sigma_m = norths.deviation() * by_root;
    return landings;
}

Result<Targeting> aim_at_target(const Aim& begin, double tolerance_m, std::size_t rounds_max,
                                const std::function<Result<CaseTable>(const Aim&)>& fly) {
    Targeting targeting;
    for (Aim aim = begin; targeting.rounds.size() < rounds_max;) {
        const auto table = fly(aim);
        if (!table) return table.error();
        const auto landings = aimed_landings(aim, *table);
        if (!landings) return landings.error();
        targeting.rounds.push_back(*landings);
        targeting.reached = landings->miss_m() <= tolerance_m;
        if (targeting.reached || targeting.rounds.size() == rounds_max) break;
        aim = {in_metres(aim.east_m - landings->east_m), in_metres(aim.north_m - landings->north_m)};
        if (std::hypot(aim.east_m, aim.north_m) > simulation::aim_max_m)
            return Error{fmt::format(
                "the mean of {} landings misses by {:.0f} m, and an aim to meet it would lie {:.0f} "
                "m from the target, more than {:.0f}: is the target within the vehicle's reach?",
                landings->landed, landings->miss_m(), std::hypot(aim.east_m, aim.north_m), simulation::aim_max_m)};
    }
    return targeting;
}

std::string targeting_table(const Targeting& targeting) {
    std::string text = fmt::format("{:>22}{:>10}{:>22}{:>22}{:>10}\n", "aim east, north m", "landed",
                                   "mean miss east m", "north m", "miss m");
    for (const AimedLandings& one : targeting.rounds)
        text += fmt::format(
            "{:>22}{:>10}{:>22}{:>22}{:>10.0f}\n", fmt::format("{:.0f}, {:.0f}", one.aim.east_m, one.aim.north_m),
            fmt::format("{}/{}", one.landed, one.cases), fmt::format("{:.0f} ± {:.0f}", one.east_m, one.east_sigma_m),
            fmt::format("{:.0f} ± {:.0f}", one.north_m, one.north_sigma_m), one.miss_m());
    return text;
}

}  // namespace aeolis::server::campaign
