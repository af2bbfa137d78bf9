// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/height_grid.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::simulation {

HeightGrid::HeightGrid(const Shape& shape, std::vector<double> heights_m)
    : shape_(shape), heights_m_(std::move(heights_m)) {
    AEOLIS_CHECK(shape.columns >= 2 && shape.rows >= 2 && heights_m_.size() == shape.columns * shape.rows);
    double east = 0.0, north = 0.0;
    for (std::size_t row = 0; row < shape.rows; ++row)
        for (std::size_t column = 0; column < shape.columns; ++column) {
            const double here_m = at_node(column, row);
            if (column > 0) east = std::max(east, std::abs(here_m - at_node(column - 1, row)));
            if (row > 0) north = std::max(north, std::abs(here_m - at_node(column, row - 1)));
        }
    steepest_ = std::hypot(east, north) / shape.cell_m;
}

HeightGrid::Place HeightGrid::place_of(double east_m, double north_m) const {
    const auto along = [&](double offset_m, std::size_t nodes, std::size_t& cell, double& fraction) {
        const double cells = offset_m / shape_.cell_m, last = static_cast<double>(nodes - 1);
        const double within = std::clamp(cells, 0.0, last);
        cell = std::min(static_cast<std::size_t>(within), nodes - 2);
        fraction = within - static_cast<double>(cell);
        return within == cells;
    };
    Place place;
    place.within_east = along(east_m - shape_.west_m, shape_.columns, place.column, place.east);
    place.within_north = along(north_m - shape_.south_m, shape_.rows, place.row, place.north);
    return place;
}

double HeightGrid::height_m(double east_m, double north_m) const {
    const Place at = place_of(east_m, north_m);
    const double south = std::lerp(at_node(at.column, at.row), at_node(at.column + 1, at.row), at.east);
    const double north = std::lerp(at_node(at.column, at.row + 1), at_node(at.column + 1, at.row + 1), at.east);
    return std::lerp(south, north, at.north);
}

HeightGrid::Rise HeightGrid::rise(double east_m, double north_m) const {
    const Place at = place_of(east_m, north_m);
    const double south_west = at_node(at.column, at.row), south_east = at_node(at.column + 1, at.row);
    const double north_west = at_node(at.column, at.row + 1), north_east = at_node(at.column + 1, at.row + 1);
    Rise rise;
    if (at.within_east)
        rise.east = std::lerp(south_east - south_west, north_east - north_west, at.north) / shape_.cell_m;
    if (at.within_north)
        rise.north = std::lerp(north_west - south_west, north_east - south_east, at.east) / shape_.cell_m;
    return rise;
}

bool HeightGrid::holds(double east_m, double north_m) const {
    const Place at = place_of(east_m, north_m);
    return at.within_east && at.within_north;
}

bool HeightGrid::covers(double reach_m) const {
    const double east_m = shape_.west_m + static_cast<double>(shape_.columns - 1) * shape_.cell_m;
    const double north_m = shape_.south_m + static_cast<double>(shape_.rows - 1) * shape_.cell_m;
    return shape_.west_m <= -reach_m && shape_.south_m <= -reach_m && east_m >= reach_m && north_m >= reach_m;
}

}  // namespace aeolis::simulation
