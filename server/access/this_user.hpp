// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis::server {

/// In an audit, the place of who starts a program instead of asking a server.
inline constexpr const char* command_line = "command line";

/// The system's name of the user that this program runs as; its number when it has none.
std::string this_user();

}  // namespace aeolis::server
