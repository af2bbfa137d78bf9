// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::net {

/// Whether a Host header ("name", "name:port", "[::1]:port") names loopback.
bool is_loopback_host(std::string_view host);

/// Why a request is no business of this server; empty: it may go on. A page of another site, or a name that was rebound
/// to this address, cannot command.
/// @param host    the Host header
/// @param origin  the Origin header; none of a program that is no browser
/// @param names   by which browsers call the server, besides those of loopback
std::string refusal_of_origin(std::string_view host, std::optional<std::string_view> origin,
                              const std::vector<std::string>& names, bool secure);

}  // namespace aeolis::server::net
