// SPDX-License-Identifier: Apache-2.0
#include "server/net/request_origin.hpp"

#include <algorithm>
#include <boost/beast/core/string.hpp>
#include <fmt/format.h>

namespace aeolis::server::net {
namespace {

using boost::beast::iequals;

std::string_view without_port(std::string_view authority) {
    const auto bracket = authority.rfind(']');
    const auto colon = authority.rfind(':');
    const bool has_port = colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
    return has_port ? authority.substr(0, colon) : authority;
}

}  // namespace

bool is_loopback_host(std::string_view host) {
    const auto name = without_port(host);
    return iequals(name, "localhost") || name == "127.0.0.1" || name == "[::1]";
}

std::string refusal_of_origin(std::string_view host, std::optional<std::string_view> origin,
                              const std::vector<std::string>& names, bool secure) {
    const auto is_this = [&](const std::string& name) { return iequals(name, without_port(host)); };
    if (!is_loopback_host(host) && std::ranges::none_of(names, is_this))
        return fmt::format("Host '{}' is not a name of this server: it answers to loopback names{}", host,
                           names.empty() ? " only" : " and to those of --host");
    // Another server's page on this machine is another origin too: only this server's own pages may send commands.
    if (origin && !iequals(*origin, fmt::format("{}://{}", secure ? "https" : "http", host)))
        return fmt::format("Origin '{}' is not a page of this server", *origin);
    return {};
}

}  // namespace aeolis::server::net
