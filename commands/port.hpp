// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

// The port of the uplink: octets that leave a station for the vehicle, simulated or real.
namespace aeolis::commands {

/// CLTUs for a station to radiate, in order.
using Uplink = std::vector<std::vector<std::uint8_t>>;

}  // namespace aeolis::commands
