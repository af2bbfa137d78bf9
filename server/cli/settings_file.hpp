// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

namespace CLI {
class App;
}

namespace aeolis::server {

/// Binds each option of `serve` but --config to an environment variable: AEOLIS_LOG_LEVEL for --log-level.
void name_environment(CLI::App& command);

/// Makes the values in the file of `serve --config` the defaults of its options. Environment and command line then take
/// precedence. Call before parsing the command line. Does nothing without such a file.
Result<void> take_settings(CLI::App& program, int argc, char** argv);

}  // namespace aeolis::server
