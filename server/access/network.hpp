// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis::server {

/// The network by which connections and password guesses are counted: an IPv4 address itself, the /64 of an IPv6
/// address. A subscriber is given a whole /64 and can use any address in it. Text that is not an address is returned
/// unchanged.
std::string network_of(const std::string& address);

}  // namespace aeolis::server
