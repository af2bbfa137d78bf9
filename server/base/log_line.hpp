// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <spdlog/formatter.h>
#include <string>
#include <string_view>

// Lines of the log. What clients send is quoted in it: none of it may begin a line of its own, or speak to a terminal.
namespace aeolis::server {

/// Control characters as \n, \t or \x1b; all else as it stands.
std::string printable(std::string_view text);

/// As spdlog's own, with a message that is printable.
std::unique_ptr<spdlog::formatter> text_lines();
/// One JSON object a line.
std::unique_ptr<spdlog::formatter> json_lines();

}  // namespace aeolis::server
