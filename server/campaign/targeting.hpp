// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/case_table.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

// Moves the point at which guidance aims until the landings of a campaign lie about the target.
namespace aeolis::server::campaign {

/// Where guidance aims, from the target. Whole metres, so that it can be written into a scenario.
struct Aim {
    double east_m = 0.0, north_m = 0.0;
    bool operator==(const Aim&) const = default;
};
Aim aim_of(const simulation::Scenario& scenario);
/// The scenario with another aim. Its name ends with it.
simulation::Scenario with_aim(const simulation::Scenario& scenario, const Aim& aim);

/// The landings by one aim.
struct AimedLandings {
    Aim aim;
    std::uint64_t cases = 0, landed = 0;
    double east_m = 0.0, north_m = 0.0;              ///< mean of the touchdowns, from the target
    double east_sigma_m = 0.0, north_sigma_m = 0.0;  ///< standard deviation of that mean
    double miss_m() const;
};
/// Fails when fewer than two landed.
Result<AimedLandings> aimed_landings(const Aim& aim, const CaseTable& table);

struct Targeting {
    std::vector<AimedLandings> rounds;
    bool reached = false;  ///< the last round's mean lies within the tolerance
};

/// Flies rounds of the same cases, each by an aim that is moved against the mean miss of the one before.
///
/// @param fly          flies the cases by an aim
/// @param tolerance_m  of the mean miss
/// Fails as `fly` does, when fewer than two cases land, and when the aim would leave what a scenario may have.
Result<Targeting> aim_at_target(const Aim& begin, double tolerance_m, std::size_t rounds_max,
                                const std::function<Result<CaseTable>(const Aim&)>& fly);

/// Table for people.
std::string targeting_table(const Targeting& targeting);

}  // namespace aeolis::server::campaign
