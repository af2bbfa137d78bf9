// SPDX-License-Identifier: Apache-2.0
#include "server/links/downlink_address.hpp"

#include <charconv>

namespace aeolis::server {

Result<DownlinkAddress> DownlinkAddress::parse(std::string_view text) {
    const Error refused{"'" + std::string{text} +
                        "': expected tcp://HOST:PORT or udp://HOST:PORT, such as tcp://127.0.0.1:5000"};
    DownlinkAddress address;
    address.udp = text.starts_with("udp://");
    if (!address.udp && !text.starts_with("tcp://")) return refused;
    const std::string_view rest = text.substr(6);
    const auto colon = rest.rfind(':');
    if (colon == std::string_view::npos || colon == 0) return refused;
    std::string_view host = rest.substr(0, colon);
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    const char* const end = rest.data() + rest.size();
    const auto [stopped, error] = std::from_chars(rest.data() + colon + 1, end, address.port);
    if (host.empty() || error != std::errc{} || stopped != end || (address.port == 0 && !address.udp)) return refused;
    address.host = host;
    return address;
}

std::string DownlinkAddress::text() const {
    const bool brackets = host.find(':') != std::string::npos;
    return std::string{udp ? "udp://" : "tcp://"} + (brackets ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

}  // namespace aeolis::server
