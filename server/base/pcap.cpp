// SPDX-License-Identifier: Apache-2.0
#include "server/base/pcap.hpp"

#include <algorithm>
#include <array>

namespace aeolis::server::pcap {
namespace {

constexpr std::uint32_t magic = 0xA1B2C3D4, magic_nanoseconds = 0xA1B23C4D, magic_pcapng = 0x0A0D0D0A;
constexpr std::size_t file_header_octets = 24, record_header_octets = 16, ip_octets = 20, udp_octets = 8;
constexpr std::uint32_t raw_ip = 101, ipv4 = 228, ethernet = 1, linux_cooked = 113;
constexpr std::int64_t epoch_2000_s = 946728000;  // 2000-01-01T12:00:00 UTC in seconds since 1970
constexpr std::int64_t microseconds_a_second = 1'000'000;

void put(std::string& to, std::uint32_t value, std::size_t octets, bool big) {
    for (std::size_t i = 0; i < octets; ++i)
        to.push_back(static_cast<char>(value >> (8 * (big ? octets - 1 - i : i)) & 0xFFU));
}

std::uint32_t big_number(std::span<const std::uint8_t> octets) {
    std::uint32_t value = 0;
    for (const std::uint8_t octet : octets) value = value << 8U | octet;
    return value;
}

void append_record(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets) {
    const std::int64_t us = ert.microseconds + epoch_2000_s * microseconds_a_second;
    const auto size = static_cast<std::uint32_t>(ip_octets + udp_octets + octets.size());
    put(to, static_cast<std::uint32_t>(us / microseconds_a_second), 4, false);
    put(to, static_cast<std::uint32_t>(us % microseconds_a_second), 4, false);
    put(to, size, 4, false);
    put(to, size, 4, false);
    constexpr std::uint32_t from = 0xC0000201, into = 0xC0000202;  // 192.0.2.1 and .2: for documentation, never routed
    constexpr std::uint32_t version_and_header = 0x4500, dont_fragment = 0x4000, life_and_udp = 0x4011;
    std::uint32_t sum = version_and_header + size + dont_fragment + life_and_udp + (from >> 16U) + (from & 0xFFFFU) +
                        (into >> 16U) + (into & 0xFFFFU);
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    for (const std::uint32_t word : {version_and_header, size, 0U, dont_fragment, life_and_udp, ~sum & 0xFFFFU})
        put(to, word, 2, true);
    put(to, from, 4, true);
    put(to, into, 4, true);
    for (const std::uint32_t word :
         {std::uint32_t{port}, std::uint32_t{port}, static_cast<std::uint32_t>(udp_octets + octets.size()), 0U})
        put(to, word, 2, true);  // a checksum of 0: none
    to.append(octets.begin(), octets.end());
}

/// The IPv4 packet in a captured one; empty: it is none.
std::span<const std::uint8_t> ip_packet(std::span<const std::uint8_t> packet, std::uint32_t link_type) {
    constexpr std::uint32_t type_ipv4 = 0x0800, type_vlan = 0x8100, type_service_vlan = 0x88A8;
    constexpr std::size_t ethernet_type_at = 12, cooked_type_at = 14, tag_octets = 4;
    if (link_type == raw_ip || link_type == ipv4) return packet;
    std::size_t at = link_type == ethernet ? ethernet_type_at : cooked_type_at;
    const auto type = [&] { return packet.size() < at + 2 ? 0 : big_number(packet.subspan(at, 2)); };
    while (type() == type_vlan || type() == type_service_vlan) at += tag_octets;
    return type() == type_ipv4 ? packet.subspan(at + 2) : std::span<const std::uint8_t>{};
}

/// The port and data of a whole UDP datagram over IPv4; none: it is something else.
std::optional<Datagram> datagram_in(std::span<const std::uint8_t> ip) {
    constexpr std::uint8_t protocol_udp = 17;
    constexpr std::uint32_t fragment_mask = 0x3FFF;  // more fragments, or an offset
    if (ip.size() < ip_octets || ip[0] >> 4U != 4) return std::nullopt;
    const std::size_t header = (ip[0] & 0xFU) * std::size_t{4};
    const std::size_t total = big_number(ip.subspan(2, 2));
    if (header < ip_octets || total < header + udp_octets || total > ip.size() || ip[9] != protocol_udp ||
        (big_number(ip.subspan(6, 2)) & fragment_mask) != 0)
        return std::nullopt;
    const auto udp = ip.subspan(header, total - header);
    const std::size_t length = big_number(udp.subspan(4, 2));
    if (length < udp_octets || length > udp.size()) return std::nullopt;
    return Datagram{
        {}, static_cast<std::uint16_t>(big_number(udp.subspan(2, 2))), udp.subspan(udp_octets, length - udp_octets)};
}

}  // namespace

std::string head() {
    constexpr std::uint32_t longest_record = 262144;
    std::string to;
    put(to, magic, 4, false);
    put(to, 2, 2, false);  // version 2.4
    put(to, 4, 2, false);
    put(to, 0, 4, false);
    put(to, 0, 4, false);
    put(to, longest_record, 4, false);
    put(to, raw_ip, 4, false);
    return to;
}

void append(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets) {
    for (std::size_t at = 0; at < octets.size(); at += datagram_octets_max)
        append_record(to, ert, port, octets.subspan(at, std::min(datagram_octets_max, octets.size() - at)));
}

bool File::is(std::span<const std::uint8_t> octets) {
    if (octets.size() < 4) return false;
    const std::uint32_t first = big_number(octets.first(4));
    const std::uint32_t turned = first >> 24U | (first >> 8U & 0xFF00U) | (first << 8U & 0xFF0000U) | first << 24U;
    return std::ranges::any_of(std::array{magic, magic_nanoseconds, magic_pcapng},
                               [&](std::uint32_t each) { return each == first || each == turned; });
}

Result<File> File::open(std::span<const std::uint8_t> octets) {
    File file;
    file.octets_ = octets;
    if (!is(octets)) return Error{"no pcap file"};
    const std::uint32_t first = big_number(octets.first(4));
    if (first == magic_pcapng) return Error{"a pcapng file: convert it, editcap -F pcap IN OUT"};
    if (octets.size() < file_header_octets) return Error{"the header of the pcap file is cut off"};
    file.swapped_ = first != magic && first != magic_nanoseconds;  // its numbers have the least octet first
    file.nanoseconds_ = file.number(0, 4) == magic_nanoseconds;
    file.link_type_ = file.number(20, 4) & 0xFFFFU;
    file.at_ = file_header_octets;
    constexpr std::array link_types{raw_ip, ipv4, ethernet, linux_cooked};
    if (std::ranges::find(link_types, file.link_type_) == link_types.end())
        return Error{"link type " + std::to_string(file.link_type_) + ": 101, 228, 1 and 113 are read"};
    return file;
}

std::uint32_t File::number(std::size_t at, std::size_t octets) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < octets; ++i) value = value << 8U | octets_[at + (swapped_ ? octets - 1 - i : i)];
    return value;
}

std::optional<Datagram> File::next() {
    while (at_ + record_header_octets <= octets_.size()) {
        const std::int64_t seconds = number(at_, 4), part = number(at_ + 4, 4);
        const std::size_t size = number(at_ + 8, 4);
        if (size > octets_.size() - at_ - record_header_octets) break;
        const auto packet = octets_.subspan(at_ + record_header_octets, size);
        at_ += record_header_octets + size;
        auto datagram = datagram_in(ip_packet(packet, link_type_));
        if (!datagram) {
            ++others_;
            continue;
        }
        constexpr std::int64_t nanoseconds_a_microsecond = 1000;
        datagram->ert = Ert{(seconds - epoch_2000_s) * microseconds_a_second +
                            (nanoseconds_ ? part / nanoseconds_a_microsecond : part)};
        return datagram;
    }
    cut_ = at_ < octets_.size();
    at_ = octets_.size();
    return std::nullopt;
}

}  // namespace aeolis::server::pcap
