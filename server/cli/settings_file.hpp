// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace aeolis::server {

/// Binds each option of `serve` but --config to an environment variable: AEOLIS_LOG_LEVEL for --log-level.
void name_environment(CLI::App& command);

/// Makes the values in the file of `serve --config` the defaults of its options. Environment and command line then take
/// precedence. Call before parsing the command line. Does nothing without such a file.
Result<void> take_settings(CLI::App& program, int argc, char** argv);

/// The value of an option of `serve`, before the command line is parsed: of the command line, else of the environment,
/// else of the file of settings. None: it is not given, or its file cannot be read.
std::optional<std::string> setting_given(int argc, char** argv, std::string_view option);

/// The value of one option in a file of settings; none: the file does not have it.
Result<std::optional<std::string>> setting_in_file(const std::filesystem::path& file, std::string_view option);

}  // namespace aeolis::server
