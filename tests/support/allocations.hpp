// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace aeolis::test {

/// How often this thread has asked for memory since the program started.
std::uint64_t allocations();

}  // namespace aeolis::test
