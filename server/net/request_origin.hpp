// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::net {

/// Whether a Host header ("name", "name:port", "[::1]:port") names loopback.
bool is_loopback_host(std::string_view host);

/// Why a request must be refused; empty: accepted. Neither a page of another site nor a name rebound to this address
/// can send commands.
/// @param host    the Host header
/// @param origin  the Origin header; none when the program is not a browser
/// @param names   the server's host names as used by browsers, besides loopback's
std::string refusal_of_origin(std::string_view host, std::optional<std::string_view> origin,
                              const std::vector<std::string>& names, bool secure);

}  // namespace aeolis::server::net
