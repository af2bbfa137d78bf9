// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/load.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::simulation {

/// The computers' load before a scenario's landing begins.
flight::Load load_for(const Scenario& scenario);

}  // namespace aeolis::simulation
