// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "simulation/mars/height_grid.hpp"

#include <filesystem>
#include <string>
#include <string_view>

// Grids of heights in the ASCII form of ESRI [esri-grid]: ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter,
// cellsize and, if a value stands for no height, NODATA_value, a line each; then the rows from north to south, each
// from west to east.
namespace aeolis::server {

/// Where the target lies by the grid's own coordinates and heights. [m]
struct GridDatum {
    double target_x_m = 0.0, target_y_m = 0.0;  ///< x counts towards east, y towards north
    double landing_m = 0.0;                     ///< height of the landing radius
};

/// Reads a grid. A height is that of its cell's middle.
///
/// Fails, "line N: why", at a key that is missing, twice or unknown, a row too short or too long, a value that is no
/// number or stands for none, heights more than 10 km from the landing radius, and steps steeper than five in one.
Result<simulation::HeightGrid> height_grid_from_text(std::string_view text, const GridDatum& datum = {});

/// The grid as text: metres from the target, heights over the landing radius. Reading gives the same numbers.
std::string grid_text(const simulation::HeightGrid& grid);

/// Reads a file. Fails as above, "FILE:N: why".
Result<simulation::HeightGrid> height_grid_from_file(const std::filesystem::path& file, const GridDatum& datum);

}  // namespace aeolis::server
