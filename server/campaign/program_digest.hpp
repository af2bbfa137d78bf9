// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>

namespace aeolis::server::campaign {

/// SHA-256 of the running program's file. Two builds that may fly differently have different digests.
Result<std::string> program_digest();

}  // namespace aeolis::server::campaign
