// SPDX-License-Identifier: Apache-2.0
#include "server/access/network.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>

namespace aeolis::server {

std::string network_of(const std::string& address) {
    in6_addr parsed{};
    if (::inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &parsed) != 1) return address;
    std::fill(std::begin(parsed.s6_addr) + 8, std::end(parsed.s6_addr), std::uint8_t{0});
    std::array<char, INET6_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET6, &parsed, text.data(), text.size());
    return std::string{text.data()} + "/64";
}

}  // namespace aeolis::server
