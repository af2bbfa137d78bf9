// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/campaign/case_table.hpp"
#include "server/campaign/limit_margins.hpp"
#include "server/campaign/statistics.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Which errors make the spread of the landings: the same campaign with one group of errors, or one error, at a time.
namespace aeolis::server::campaign {

/// Errors that belong together, or a single one: names of fields of `dispersions`.
struct ErrorGroup {
    std::string name;
    std::vector<std::string> fields;
};
/// Every field of `dispersions` in exactly one group: delivery, knowledge, imu, density, drag, mass, wind, parachute,
/// radar and terrain.
const std::vector<ErrorGroup>& error_groups();
/// Each error that the scenario has, alone.
std::vector<ErrorGroup> single_errors(const simulation::Scenario& scenario);
/// The scenario with only those errors, by its own deviations. Its name ends with the group's.
simulation::Scenario with_errors(const simulation::Scenario& scenario, const ErrorGroup& group);

/// Spread of the landings under one group of errors. What fewer than two landings have is no number.
struct Influence {
    std::string group;
    std::uint64_t cases = 0, landed = 0;
    double along_m = unknown, across_m = unknown;  ///< standard deviation of the touchdown by the course at the target
    std::optional<Ellipse> ellipse;
    double vertical_mps = unknown, horizontal_mps = unknown;  ///< standard deviations, as below
    double propellant_kg = unknown, parachute_mach = unknown, parachute_pressure_Pa = unknown,
           peak_deceleration_mps2 = unknown;
    double propellant_least_kg = unknown;  ///< of all cases
};
/// @param course_deg  azimuth of the course at the target
Influence influence_of(const std::string& group, const CaseTable& table, double course_deg);

/// Table for people: the strongest along the course first, then the root of the sum of squares, and all errors at once.
std::string sensitivity_table(const std::vector<Influence>& influences, const Influence& all);
std::string sensitivity_csv(const std::vector<Influence>& influences, const Influence& all);

}  // namespace aeolis::server::campaign
