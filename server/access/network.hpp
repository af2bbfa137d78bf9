// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis::server {

/// What one subscriber is given, of an address: of version 4 itself, of version 6 its /64, in which everybody has as
/// many addresses as they like. Of what is no address, itself. By this connections and guesses are counted.
std::string network_of(const std::string& address);

}  // namespace aeolis::server
