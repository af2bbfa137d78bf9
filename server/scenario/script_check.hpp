// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::server {

/// Whether the dictionary knows every command and argument that the scenario itself will send, and can encode them.
/// Else the first that it cannot, as "commands[1].command: 'EDL_FROB' is no command of the dictionary": before the
/// start, not an hour in.
Result<void> check_script(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
