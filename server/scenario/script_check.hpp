// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::server {

/// Checks that the dictionary can encode every command that the scenario itself will send: before the start, not an
/// hour into the run. The Error names the first fault: "commands[1].command: 'EDL_FROB' is no command of the
/// dictionary".
Result<void> check_script(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
