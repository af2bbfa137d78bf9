// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>

namespace aeolis::server::campaign {

/// SHA-256 of the program that runs, as its file has it: two builds that may fly differently differ in it.
Result<std::string> program_digest();

}  // namespace aeolis::server::campaign
