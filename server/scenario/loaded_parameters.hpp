// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/scenario.pb.h"
#include "common/ids.hpp"
#include "common/result.hpp"
#include "flight/load.hpp"

#include <utility>
#include <vector>

// The parameters of parameters.csv that a scenario's vehicle is loaded with, by name. The others have their defaults.
namespace aeolis::server {

/// Reads them. The Error names the row and its parameter: one that parameters.csv does not have, that is fixed when
/// flight is built, that is named twice, or whose value is outside its range.
Result<flight::Parameters> parameters_of(const v1::Scenario& message);

/// Writes those that are not the defaults.
void write_parameters(const flight::Parameters& parameters, v1::Scenario& message);

/// Those that are not the defaults.
std::vector<std::pair<ParameterId, double>> loaded_parameters(const flight::Parameters& parameters);

}  // namespace aeolis::server
