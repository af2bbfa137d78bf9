// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/load.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::simulation {

/// What is loaded into the vehicle's computers before the landing of a scenario begins.
flight::Load load_for(const Scenario& scenario);

}  // namespace aeolis::simulation
