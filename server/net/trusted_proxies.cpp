// SPDX-License-Identifier: Apache-2.0
#include "server/net/trusted_proxies.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <span>

namespace aeolis::server::net {
namespace {

namespace ip = boost::asio::ip;

constexpr unsigned v4_bits = 32, v6_bits = 128;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::optional<ip::address> address_in(std::string_view text) {
    boost::system::error_code error;
    const auto address = ip::make_address(std::string{text}, error);
    if (error) return std::nullopt;
    if (address.is_v6() && address.to_v6().is_v4_mapped()) return ip::make_address_v4(ip::v4_mapped, address.to_v6());
    return address;
}

/// Reads an address as proxies write it: with a port or without.
std::optional<ip::address> forwarded_address(std::string_view text) {
    if (text.starts_with('[') && text.find(']') != std::string_view::npos)
        return address_in(text.substr(1, text.find(']') - 1));
    return address_in(std::ranges::count(text, ':') == 1 ? text.substr(0, text.find(':')) : text);
}

std::array<std::uint8_t, 16> octets_of(const ip::address& address) {
    return (address.is_v6() ? address.to_v6() : ip::make_address_v6(ip::v4_mapped, address.to_v4())).to_bytes();
}

bool same_bits(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, unsigned bits) {
    for (unsigned i = 0; i < bits; ++i)
        if (((a[i / 8] ^ b[i / 8]) >> (7U - i % 8)) & 1U) return false;
    return true;
}

}  // namespace

Result<TrustedProxies> TrustedProxies::parse(const std::vector<std::string>& texts) {
    TrustedProxies proxies;
    for (const auto& text : texts) {
        const auto slash = text.find('/');
        const auto address = address_in(std::string_view{text}.substr(0, slash));
        const unsigned bits = address && address->is_v4() ? v4_bits : v6_bits;
        unsigned prefix = bits;
        if (slash != std::string::npos) {
            const char* const end = text.data() + text.size();
            const auto [stopped, error] = std::from_chars(text.data() + slash + 1, end, prefix);
            if (error != std::errc{} || stopped != end) prefix = v6_bits + 1;
        }
        if (!address || prefix > bits)
            return Error{fmt::format("--trusted-proxies: '{}' is no address, nor a network such as 10.0.0.0/8", text)};
        proxies.networks_.push_back({octets_of(*address), prefix + v6_bits - bits});
    }
    return proxies;
}

bool TrustedProxies::contains(std::string_view text) const {
    const auto address = address_in(text);
    return address && std::ranges::any_of(networks_, [octets = octets_of(*address)](const Network& network) {
               return same_bits(octets, network.address, network.prefix_bits);
           });
}

std::string TrustedProxies::client(const std::string& peer, std::string_view forwarded_for) const {
    std::string from = peer;
    std::string_view rest = trimmed(forwarded_for);
    while (contains(from) && !rest.empty()) {
        const auto comma = rest.rfind(',');
        const auto before = forwarded_address(trimmed(comma == std::string_view::npos ? rest : rest.substr(comma + 1)));
        if (!before) break;
        from = before->to_string();
        rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(0, comma);
    }
    return from;
}

}  // namespace aeolis::server::net
