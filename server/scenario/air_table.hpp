// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <vector>

// Tables of air and wind over height, as analysts have them.
//
// CSV      a heading that names each column with its unit: altitude_m or altitude_km; two or three of temperature_K,
//          pressure_Pa and density_kgm3; east_mps and north_mps (velocity of the air); density_scale,
//          by which density is multiplied, and density_deviation, its standard deviation as a fraction. Lines with #
//          are comments
// Profile  of Mars-GRAM (auxiliary profile): one line of heading, then height km, latitude, longitude, temperature K,
//          pressure Pa, density kg/m³, eastward and northward wind m/s, and deviations that are not used. [facts]
// Zero     as temperature, pressure or density: none; the gas law gives it from the other two
namespace aeolis::server {

struct AirTable {
    std::vector<simulation::AirRow> air;
    std::vector<simulation::WindRow> winds;       ///< empty: the table has none
    std::vector<simulation::DensityScale> scale;  ///< scale and deviation by height; empty: the table has neither
};

/// Reads a table of either form, told apart by the comma. Heights become those above the landing radius.
///
/// @param landing_m  height of the landing radius by the table's own heights
/// Fails, "FILE:LINE: why", at a row that is no number, lies not above the one before, leaves a gap over 25 km, has
/// values that no air has, or values that contradict the gas law by a fifth below 100 km: units of another kind.
Result<AirTable> air_table_from_file(const std::filesystem::path& file, double landing_m = 0.0);

/// Reads a CSV with the columns altitude_m or altitude_km, east_mps and north_mps.
Result<std::vector<simulation::WindRow>> wind_table_from_file(const std::filesystem::path& file);

}  // namespace aeolis::server
