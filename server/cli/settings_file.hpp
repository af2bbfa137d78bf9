// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

namespace CLI {
class App;
}

namespace aeolis::server {

/// Gives each option of `serve` the environment variable of its name: AEOLIS_LOG_LEVEL for --log-level. Not --config.
void name_environment(CLI::App& command);

/// Makes the values in the file that `serve --config` names the defaults of its options, so that environment and
/// command line take precedence. Before the command line is parsed; does nothing without such a file.
Result<void> take_settings(CLI::App& program, int argc, char** argv);

}  // namespace aeolis::server
