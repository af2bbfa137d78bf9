// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace aeolis::server {

/// The address of another mission's downlink: "tcp://HOST:PORT" to connect to, "udp://HOST:PORT" to listen at. HOST is
/// a name or an address, [::1] in brackets; PORT is 1 … 65535, for UDP also 0: any free port.
struct DownlinkAddress {
    bool udp = false;
    std::string host;
    std::uint16_t port = 0;

    static Result<DownlinkAddress> parse(std::string_view text);
    std::string text() const;
};

}  // namespace aeolis::server
