// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis::server {

/// The audit's address (`from`) of a program that was started on the command line and sent no request.
inline constexpr const char* command_line = "command line";

/// The system user name that this program runs as; the user id when it has no name.
std::string this_user();

}  // namespace aeolis::server
