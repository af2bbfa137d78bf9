// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

// The port of the uplink: what leaves a station towards the vehicle, whoever it is that hears it.
namespace aeolis::commands {

/// Octets that a station radiates, a unit each, in their order: CLTUs.
using Uplink = std::vector<std::vector<std::uint8_t>>;

}  // namespace aeolis::commands
