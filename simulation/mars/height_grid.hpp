// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace aeolis::simulation {

/// Heights of the ground at the nodes of an even grid around the target, bilinear between them.
///
/// Beyond its nodes the height at its edge goes on.
class HeightGrid {
  public:
    /// Offsets are metres from the target, along its east and north.
    struct Shape {
        std::size_t columns = 0, rows = 0;   ///< at least two each
        double west_m = 0.0, south_m = 0.0;  ///< of the westernmost and southernmost nodes
        double cell_m = 0.0;                 ///< between neighbours
    };
    /// Rise of the ground for each metre towards east and north.
    struct Rise {
        double east = 0.0, north = 0.0;
    };

    /// @param heights_m  over the landing radius; rows from south to north, each from west to east
    HeightGrid(const Shape& shape, std::vector<double> heights_m);

    const Shape& shape() const { return shape_; }
    double at_node(std::size_t column, std::size_t row) const { return heights_m_[row * shape_.columns + column]; }
    double height_m(double east_m, double north_m) const;
    /// Zero beyond the nodes, in the direction that leaves them.
    Rise rise(double east_m, double north_m) const;
    /// No slope of the ground is steeper: a bound of the rise for each horizontal metre, in any direction.
    double steepest() const { return steepest_; }
    /// Whether a place lies within the nodes.
    bool holds(double east_m, double north_m) const;
    /// Whether the nodes lie around all places up to `reach_m` from the target, in any direction.
    bool covers(double reach_m) const;

  private:
    /// The cell of a place, and where in it: fractions from its south-western node.
    struct Place {
        std::size_t column = 0, row = 0;
        double east = 0.0, north = 0.0;
        bool within_east = true, within_north = true;
    };
    Place place_of(double east_m, double north_m) const;

    Shape shape_;
    std::vector<double> heights_m_;
    double steepest_ = 0.0;
};

}  // namespace aeolis::simulation
