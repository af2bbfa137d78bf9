// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// The words of the command line without the program's name, and behind the command each option that stands in the
/// environment and not among them, as if it were typed: so that its value is checked and a wrong one refused. By itself
/// CLI11 from 2.4 on ignores a variable with a wrong value.
std::vector<std::string> with_environment(const CLI::App& program, int argc, char** argv);

/// The value of one option in a file of settings; none: the file does not have it.
Result<std::optional<std::string>> setting_in_file(const std::filesystem::path& file, std::string_view option);

}  // namespace aeolis::server
