// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <spdlog/formatter.h>
#include <string>
#include <string_view>

// Log lines. They quote what clients send, which must not begin a line of its own or control a terminal.
namespace aeolis::server {

/// Escapes control characters as \n, \t or \x1b; leaves all else unchanged.
std::string printable(std::string_view text);

/// Prints a line outside the log. After print_json() it is an object like the log's, with level error on stderr.
void print_line(std::FILE* to, std::string_view text);
void print_json();

/// Logs a line of the level info whatever the log's level is, unless that is off: for what must not be missing.
void log_always(std::string_view text);

/// spdlog's own format, with a printable message.
std::unique_ptr<spdlog::formatter> text_lines();
/// One JSON object a line.
std::unique_ptr<spdlog::formatter> json_lines();

}  // namespace aeolis::server
