// SPDX-License-Identifier: Apache-2.0
#include "server/base/pcap.hpp"

#include <algorithm>
#include <array>

namespace aeolis::server::pcap {
namespace {

constexpr std::uint32_t order = 0x1A2B3C4D;  // of octets, in a section of pcapng
constexpr std::uint32_t magic = 0xA1B2C3D4, magic_nanoseconds = 0xA1B23C4D, magic_pcapng = 0x0A0D0D0A;
constexpr std::size_t file_header_octets = 24, record_header_octets = 16, ip_octets = 20, udp_octets = 8;
constexpr std::uint32_t raw_ip = 101, raw_ip_of_bsd = 12, ipv4 = 228, ethernet = 1, linux_cooked = 113,
                        linux_cooked_2 = 276;
constexpr std::array link_types{raw_ip, raw_ip_of_bsd, ipv4, ethernet, linux_cooked, linux_cooked_2};
constexpr std::size_t record_octets_max = std::size_t{1} << 24U;  // chosen: tcpdump's longest is 2^18
constexpr std::int64_t epoch_2000_s = 946728000;                  // 2000-01-01T12:00:00 UTC in seconds since 1970
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

std::uint32_t turned(std::uint32_t value) {
    return value >> 24U | (value >> 8U & 0xFF00U) | (value << 8U & 0xFF0000U) | value << 24U;
}

constexpr std::uint32_t from = 0xC0000201, into = 0xC0000202;  // 192.0.2.1 and .2: for documentation, never routed

void append_record(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets, bool stream) {
    const std::int64_t us = ert.microseconds + epoch_2000_s * microseconds_a_second;
    const auto size = static_cast<std::uint32_t>(ip_octets + udp_octets + octets.size());
    put(to, static_cast<std::uint32_t>(us / microseconds_a_second), 4, false);
    put(to, static_cast<std::uint32_t>(us % microseconds_a_second), 4, false);
    put(to, size, 4, false);
    put(to, size, 4, false);
    constexpr std::uint32_t version_and_header = 0x4500, dont_fragment = 0x4000, life_and_udp = 0x4011;
    std::uint32_t sum = version_and_header + size + dont_fragment + life_and_udp + (from >> 16U) + (from & 0xFFFFU) +
                        (into >> 16U) + (into & 0xFFFFU);
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    for (const std::uint32_t word : {version_and_header, size, 0U, dont_fragment, life_and_udp, ~sum & 0xFFFFU})
        put(to, word, 2, true);
    put(to, from, 4, true);
    put(to, into, 4, true);
    for (const std::uint32_t word : {std::uint32_t{stream ? stream_port : port}, std::uint32_t{port},
                                     static_cast<std::uint32_t>(udp_octets + octets.size()), 0U})
        put(to, word, 2, true);  // a checksum of 0: none
    to.append(octets.begin(), octets.end());
}

/// The IPv4 packet in a captured one; empty: it is none.
std::span<const std::uint8_t> ip_packet(std::span<const std::uint8_t> packet, std::uint32_t link_type) {
    constexpr std::uint32_t type_ipv4 = 0x0800, type_vlan = 0x8100, type_service_vlan = 0x88A8;
    constexpr std::size_t ethernet_type_at = 12, cooked_type_at = 14, tag_octets = 4, cooked_2_octets = 20;
    if (link_type == raw_ip || link_type == raw_ip_of_bsd || link_type == ipv4) return packet;
    if (link_type == linux_cooked_2)
        return packet.size() >= cooked_2_octets && big_number(packet.first(2)) == type_ipv4
                   ? packet.subspan(cooked_2_octets)
                   : std::span<const std::uint8_t>{};
    if (link_type != ethernet && link_type != linux_cooked) return {};
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
    const bool stream = big_number(udp.first(2)) == stream_port && big_number(ip.subspan(12, 4)) == from &&
                        big_number(ip.subspan(16, 4)) == into;
    return Datagram{{},
                    static_cast<std::uint16_t>(big_number(udp.subspan(2, 2))),
                    udp.subspan(udp_octets, length - udp_octets),
                    stream};
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

void append(std::string& to, Ert ert, std::uint16_t port, std::span<const std::uint8_t> octets, bool stream) {
    for (std::size_t at = 0; at < octets.size(); at += datagram_octets_max)
        append_record(to, ert, port, octets.subspan(at, std::min(datagram_octets_max, octets.size() - at)), stream);
}

bool File::is(std::span<const std::uint8_t> beginning) {
    if (beginning.size() < 4) return false;
    const std::uint32_t first = big_number(beginning.first(4));
    return std::ranges::any_of(std::array{magic, magic_nanoseconds, magic_pcapng},
                               [&](std::uint32_t each) { return each == first || each == turned(first); });
}

Result<File> File::open(std::span<const std::uint8_t> octets) {
    return open([octets](std::size_t at, std::size_t size) {
        return at < octets.size() ? octets.subspan(at, std::min(size, octets.size() - at))
                                  : std::span<const std::uint8_t>{};
    });
}

Result<File> File::open(Source source) {
    File file{std::move(source)};
    const auto header = file.source_(0, file_header_octets);
    if (!is(header)) return Error{"no pcap file"};
    const std::uint32_t first = big_number(header.first(4));
    file.next_generation_ = first == magic_pcapng;
    if (file.next_generation_) {
        constexpr std::size_t order_at = 8;
        const bool sound =
            header.size() >= order_at + 4 && std::ranges::any_of(std::array{order, turned(order)}, [&](auto each) {
                return each == big_number(header.subspan(order_at, 4));
            });
        if (!sound) return Error{"the first block of the pcapng file is cut off or damaged"};
        return file;
    }
    if (header.size() < file_header_octets) return Error{"the header of the pcap file is cut off"};
    file.swapped_ = first != magic && first != magic_nanoseconds;  // its numbers have the least octet first
    constexpr std::uint64_t a_thousand_million = 1'000'000'000, a_million = 1'000'000;
    const auto link_type = static_cast<std::uint32_t>(file.number(header.subspan(20, 4)) & 0xFFFFU);
    file.interfaces_.push_back(
        {link_type, file.number(header.first(4)) == magic_nanoseconds ? a_thousand_million : a_million, 0});
    file.at_ = file_header_octets;
    if (std::ranges::find(link_types, link_type) == link_types.end())
        return Error{"link type " + std::to_string(link_type) + ": 101, 12, 228, 1, 113 and 276 are read"};
    return file;
}

std::uint64_t File::number(std::span<const std::uint8_t> octets) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < octets.size(); ++i) value = value << 8U | octets[swapped_ ? octets.size() - 1 - i : i];
    return value;
}

/// Units of time since 1970, without overflow.
Ert File::ert_of(std::uint64_t units, const Interface& by) {
    constexpr std::uint64_t seconds_max = std::uint64_t{1} << 40U;  // as good as never
    const std::uint64_t seconds = std::min(units / by.units_a_second, seconds_max);
    const auto part = static_cast<long double>(units % by.units_a_second) * microseconds_a_second /
                      static_cast<long double>(by.units_a_second);
    return Ert{(static_cast<std::int64_t>(seconds) + by.offset_s - epoch_2000_s) * microseconds_a_second +
               static_cast<std::int64_t>(part)};
}

std::optional<File::Captured> File::next_of_pcap() {
    const auto header = source_(at_, record_header_octets);
    if (header.size() < record_header_octets) {
        cut_ = !header.empty();
        return std::nullopt;
    }
    const Interface& only = interfaces_.front();
    const std::uint64_t seconds = number(header.first(4)), part = number(header.subspan(4, 4));
    const auto size = static_cast<std::size_t>(number(header.subspan(8, 4)));
    const auto packet = size <= record_octets_max ? source_(at_ + record_header_octets, size) : header.first(0);
    cut_ = size > record_octets_max || packet.size() < size;
    if (cut_) return std::nullopt;
    at_ += record_header_octets + size;
    return Captured{ert_of(seconds * only.units_a_second + part, only), only.link_type, packet};
}

void File::add_interface(std::span<const std::uint8_t> body) {
    constexpr std::size_t options_at = 8, option_header_octets = 4;
    constexpr std::uint64_t end_of_options = 0, resolution = 9, offset = 14;
    Interface one{.link_type = static_cast<std::uint32_t>(body.size() < 2 ? 0 : number(body.first(2)))};
    for (std::size_t at = options_at; at + option_header_octets <= body.size();) {
        const std::uint64_t code = number(body.subspan(at, 2));
        const auto size = static_cast<std::size_t>(number(body.subspan(at + 2, 2)));
        at += option_header_octets;
        if (code == end_of_options || size > body.size() - at) break;
        if (code == resolution && size == 1) {
            // Either a power of ten, or with the first bit set a power of two.
            constexpr unsigned of_two = 0x80, ten_max = 19, two_max = 63;
            const unsigned power = body[at] & ~of_two;
            one.units_a_second = 1;
            if ((body[at] & of_two) != 0)
                one.units_a_second = std::uint64_t{1} << std::min(power, two_max);
            else
                for (unsigned i = 0; i < std::min(power, ten_max); ++i) one.units_a_second *= 10;
        } else if (code == offset && size == 8) {
            constexpr std::int64_t offset_max_s = std::int64_t{1} << 40U;
            one.offset_s =
                std::clamp(static_cast<std::int64_t>(number(body.subspan(at, size))), -offset_max_s, offset_max_s);
        }
        at += (size + 3) / 4 * 4;
    }
    interfaces_.push_back(one);
}

std::optional<File::Captured> File::next_of_pcapng() {
    constexpr std::size_t block_header_octets = 8, block_end_octets = 4, order_octets = 4;
    constexpr std::uint64_t interface_description = 1, obsolete_packet = 2, simple_packet = 3, enhanced_packet = 6;
    for (;;) {
        const auto begin = source_(at_, block_header_octets + order_octets);
        cut_ = !begin.empty();
        if (begin.size() < block_header_octets + order_octets) return std::nullopt;
        // A section has an order of its own, and its type reads the same in both.
        const bool section = big_number(begin.first(4)) == magic_pcapng;
        if (section) {
            swapped_ = big_number(begin.subspan(block_header_octets, order_octets)) != order;
            if (number(begin.subspan(block_header_octets, order_octets)) != order) return std::nullopt;
            interfaces_.clear();
        }
        const std::uint64_t type = number(begin.first(4)), whole = number(begin.subspan(4, 4));
        if (whole % 4 != 0 || whole < block_header_octets + block_end_octets || whole > record_octets_max)
            return std::nullopt;
        const auto block = source_(at_, static_cast<std::size_t>(whole));
        if (block.size() < whole || number(block.last(block_end_octets)) != whole) return std::nullopt;
        at_ += block.size();
        cut_ = false;
        const auto body = block.subspan(block_header_octets, block.size() - block_header_octets - block_end_octets);
        if (section) continue;
        if (type == interface_description) add_interface(body);
        if (type == simple_packet) ++others_;  // it has no time
        if (type != enhanced_packet && type != obsolete_packet) continue;
        constexpr std::size_t packet_at = 20;
        const std::size_t size = body.size() < packet_at ? 0 : static_cast<std::size_t>(number(body.subspan(12, 4)));
        const std::uint64_t which = body.size() < packet_at ? 0 : number(body.first(type == enhanced_packet ? 4 : 2));
        if (body.size() < packet_at || size > body.size() - packet_at || which >= interfaces_.size()) {
            ++others_;
            continue;
        }
        const Interface& by = interfaces_[static_cast<std::size_t>(which)];
        const std::uint64_t units = number(body.subspan(4, 4)) << 32U | number(body.subspan(8, 4));
        return Captured{ert_of(units, by), by.link_type, body.subspan(packet_at, size)};
    }
}

std::optional<Datagram> File::next() {
    while (const auto captured = next_generation_ ? next_of_pcapng() : next_of_pcap()) {
        if (auto datagram = datagram_in(ip_packet(captured->packet, captured->link_type))) {
            datagram->ert = captured->ert;
            return datagram;
        }
        ++others_;
    }
    return std::nullopt;
}

}  // namespace aeolis::server::pcap
