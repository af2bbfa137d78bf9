// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"

#include <array>

namespace aeolis {
namespace {

constexpr unsigned unsegmented = 3;

bool whole_with_good_crc(std::span<const std::uint8_t> packet, const PrimaryHeader& header) {
    return packet.size() == header.packet_octets() && packet.size() >= primary_header_octets + packet_crc_octets &&
           crc16(packet.first(packet.size() - packet_crc_octets)) ==
               read_bits(packet, (packet.size() - packet_crc_octets) * 8, 16);
}

void put_primary_header(BitWriter& writer, const PrimaryHeader& header) {
    writer.put(0, 3);
    writer.put(header.telecommand, 1);
    writer.put(header.secondary_header, 1);
    writer.put(header.apid.value, 11);
    writer.put(unsegmented, 2);
    writer.put(header.count, 14);
    writer.put(header.length, 16);
}

void write_crc(std::span<std::uint8_t> packet) {
    const std::uint16_t crc = crc16(packet.first(packet.size() - packet_crc_octets));
    packet[packet.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
    packet[packet.size() - 1] = static_cast<std::uint8_t>(crc & 0xFF);
}

void clear(std::span<std::uint8_t> octets) {
    for (auto& octet : octets) octet = 0;
}

}  // namespace

void write_primary_header(const PrimaryHeader& header, std::span<std::uint8_t> packet) {
    clear(packet.first(primary_header_octets));
    BitWriter writer{packet.first(primary_header_octets)};
    put_primary_header(writer, header);
}

std::optional<PrimaryHeader> read_primary_header(std::span<const std::uint8_t> octets) {
    if (octets.size() < primary_header_octets) return std::nullopt;
    // Every packet passes here some times: whole octets, not bit by bit.
    const auto word = [&](std::size_t at) { return static_cast<unsigned>(octets[at] << 8U | octets[at + 1]); };
    const unsigned identification = word(0), sequence = word(2);
    if (identification >> 13U != 0 || sequence >> 14U != unsegmented) return std::nullopt;
    PrimaryHeader header;
    header.telecommand = (identification >> 12U & 1U) != 0;
    header.secondary_header = (identification >> 11U & 1U) != 0;
    header.apid = {static_cast<std::uint16_t>(identification & 0x7FFU)};
    header.count = static_cast<std::uint16_t>(sequence & 0x3FFFU);
    header.length = static_cast<std::uint16_t>(word(4));
    return header;
}

std::optional<std::size_t> space_packet_octets(std::span<const std::uint8_t> octets) {
    if (octets.size() < primary_header_octets || octets[0] >> 5 != 0) return std::nullopt;
    return primary_header_octets + (std::size_t{octets[4]} << 8) + octets[5] + 1;
}

PacketStart packet_start(std::span<const std::uint8_t> octets) {
    constexpr unsigned space_version = 0, encapsulation_version = 7;
    constexpr std::array<std::size_t, 4> header_sizes{1, 2, 4, 8};  // by the length of the length
    const unsigned version = octets[0] >> 5U;
    using enum PacketStart::Kind;
    if (version == space_version) {
        const auto size = space_packet_octets(octets);
        if (!size) return {space, 0};
        return {read_bits(octets, 5, 11) == idle_apid ? idle : space, *size};
    }
    if (version != encapsulation_version) return {};
    const unsigned protocol = (octets[0] >> 2U) & 7U;
    const std::size_t header = header_sizes.at(octets[0] & 3U);
    const auto kind = protocol == 0 ? idle : encapsulation;
    if (header == 1) return protocol == 0 ? PacketStart{idle, 1} : PacketStart{};
    if (octets.size() < header) return {kind, 0};
    const auto length_bits = static_cast<unsigned>(header == 2 ? 8 : header * 4);
    const auto size = read_bits(octets, header * 8 - length_bits, length_bits);
    return size < header || size > encapsulation_octets_max ? PacketStart{} : PacketStart{kind, size};
}

std::optional<TmHeader> read_tm_packet(std::span<const std::uint8_t> packet) {
    const auto primary = read_primary_header(packet);
    if (!primary || primary->telecommand || !primary->secondary_header || packet.size() < tm_overhead_octets ||
        !whole_with_good_crc(packet, *primary))
        return std::nullopt;
    const auto coarse = static_cast<double>(read_bits(packet, 48, 32));
    const auto fine = static_cast<double>(read_bits(packet, 80, 16));
    return TmHeader{*primary, Sclk{coarse + fine / 65536.0}, static_cast<std::uint16_t>(read_bits(packet, 96, 16))};
}

void seal_tm_packet(std::span<std::uint8_t> packet, Apid apid, std::uint16_t count, Sclk time,
                    std::uint16_t dictionary_id) {
    AEOLIS_CHECK(packet.size() >= tm_overhead_octets && packet.size() <= 65536 + primary_header_octets);
    clear(packet.first(tm_data_offset_octets));
    BitWriter writer{packet};
    put_primary_header(
        writer, {false, true, apid, count, static_cast<std::uint16_t>(packet.size() - primary_header_octets - 1)});
    const auto coarse = static_cast<std::uint64_t>(time.seconds);
    writer.put(coarse, 32);
    writer.put(static_cast<std::uint64_t>((time.seconds - static_cast<double>(coarse)) * 65536.0), 16);
    writer.put(dictionary_id, 16);
    write_crc(packet);
}

void seal_tc_packet(std::span<std::uint8_t> packet, Apid apid, std::uint16_t count, Opcode opcode) {
    AEOLIS_CHECK(packet.size() >= tc_overhead_octets && packet.size() <= 65536 + primary_header_octets);
    clear(packet.first(tc_arguments_offset_octets));
    BitWriter writer{packet};
    // The opcode is the packet's secondary header.
    put_primary_header(
        writer, {true, true, apid, count, static_cast<std::uint16_t>(packet.size() - primary_header_octets - 1)});
    writer.put(opcode.value, 16);
    write_crc(packet);
}

std::optional<TcPacket> read_tc_packet(std::span<const std::uint8_t> packet) {
    const auto primary = read_primary_header(packet);
    if (!primary || !primary->telecommand || packet.size() < tc_overhead_octets ||
        !whole_with_good_crc(packet, *primary))
        return std::nullopt;
    return TcPacket{*primary, Opcode{static_cast<std::uint16_t>(read_bits(packet, 48, 16))},
                    packet.subspan(tc_arguments_offset_octets, packet.size() - tc_overhead_octets)};
}

}  // namespace aeolis
