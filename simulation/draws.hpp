// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

#include <string>
#include <vector>

namespace aeolis::simulation {

/// A seeded error of one case, as it was drawn; the name is the field of Dispersions, with the axis where it has some.
struct Draw {
    std::string name;
    double value = 0.0;
};

/// Adds the three axes of an error: "imu_bias" and "mps2" give imu_bias_x_mps2 and so on.
inline void add_axes(std::vector<Draw>& draws, const std::string& name, const std::string& unit, const Vector3& value) {
    draws.push_back({name + "_x_" + unit, value.x()});
    draws.push_back({name + "_y_" + unit, value.y()});
    draws.push_back({name + "_z_" + unit, value.z()});
}

}  // namespace aeolis::simulation
