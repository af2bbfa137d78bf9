// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace aeolis::test {

/// The number of allocations by this thread since the program started.
std::uint64_t allocations();

}  // namespace aeolis::test
