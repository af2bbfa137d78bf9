// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::net {

/// The proxies in front of the server, whose X-Forwarded-For is trusted. Without it, everybody behind a proxy would
/// count as one client.
class TrustedProxies {
  public:
    /// Reads addresses and networks ("127.0.0.1", "10.0.0.0/8", "fd00::/8"). Fails with the text that is neither.
    static Result<TrustedProxies> parse(const std::vector<std::string>& texts);
    /// Whether the address is a proxy's; false for text that is not an address.
    bool contains(std::string_view address) const;
    /// The address from which a request comes: the peer's, or the last one of X-Forwarded-For that is not a trusted
    /// proxy's. Addresses before that one are only claimed by the client, and are ignored. Text that is not an address
    /// ends the search at the proxy that passed it on.
    std::string client(const std::string& peer, std::string_view forwarded_for) const;

  private:
    using Address = std::array<std::uint8_t, 16>;  ///< IPv6; of IPv4 the mapped one
    struct Network {
        Address address{};
        unsigned prefix_bits = 0;
    };
    std::vector<Network> networks_;
};

}  // namespace aeolis::server::net
