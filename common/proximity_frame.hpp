// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/parsed.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis {

/// Proximity-1 version 3 transfer frame, and the PLTU (transmission unit) that carries it over UHF.
/// [ccsds-211.0-b-6] [ccsds-211.2-b-3]
///
///   header 40 bits: version 2 (10) | expedited 1 | supervisory 1 | construction 2 | spacecraft 10 |
///                   physical channel 1 | port 3 | source or destination 1 | octets of the frame less one 11 |
///                   frame sequence 8
///   PLTU: FAF320 | frame | CRC-32 over the frame only
inline constexpr std::size_t proximity_header_octets = 5;
inline constexpr std::size_t proximity_data_octets_max = 2043;
inline constexpr std::size_t proximity_frame_octets_max = proximity_header_octets + proximity_data_octets_max;
inline constexpr std::array<std::uint8_t, 3> pltu_marker{0xFA, 0xF3, 0x20};
inline constexpr std::size_t pltu_crc_octets = 4;
inline constexpr std::size_t pltu_overhead_octets = pltu_marker.size() + proximity_header_octets + pltu_crc_octets;
inline constexpr std::size_t pltu_octets_max = pltu_overhead_octets + proximity_data_octets_max;

/// Content of a user frame's data field.
enum class Construction : std::uint8_t {
    packets = 0,   ///< whole packets, one after another
    segments = 1,  ///< one segment of a packet, after a segment header
    reserved = 2,
    octets = 3,  ///< anything, by agreement
};

struct ProximityHeader {
    bool expedited = true;
    bool supervisory = false;
    Construction construction = Construction::packets;
    std::uint16_t spacecraft = 0;  ///< 10 bits
    std::uint8_t physical_channel = 0;
    std::uint8_t port = 0;       ///< 3 bits
    bool to_spacecraft = false;  ///< true: the spacecraft id is the destination's; false: the source's
    std::uint8_t sequence = 0;   ///< counts frames of one spacecraft, physical channel and service, modulo 256

    constexpr bool operator==(const ProximityHeader&) const = default;
};

struct ProximityFrame {
    ProximityHeader header;
    std::span<const std::uint8_t> data;
};

/// Length in octets of the frame whose header begins `octets`.
/// Fails with too_short when the header is incomplete; other_version; bad_field when the length is less than the
/// header's own.
Parsed<std::size_t> proximity_frame_octets(std::span<const std::uint8_t> octets);

/// Parses a whole frame, without marker and CRC.
Parsed<ProximityFrame> read_proximity_frame(std::span<const std::uint8_t> frame);

/// Parses a whole PLTU, from the marker to the CRC.
Parsed<ProximityFrame> read_pltu(std::span<const std::uint8_t> pltu);

/// Writes the PLTU of `data` (1 … 2043 octets) and returns the number of octets written.
/// `into` must have room for pltu_overhead_octets + data.size().
std::size_t write_pltu(const ProximityHeader& header, std::span<const std::uint8_t> data, std::span<std::uint8_t> into);

/// The octet that precedes a segment: sequence flags 2 | pseudo packet id 6.
struct SegmentHeader {
    bool first = true;
    bool last = true;
    std::uint8_t pseudo_packet = 0;  ///< 6 bits: tells apart segments of packets that are sent concurrently
};
constexpr SegmentHeader read_segment_header(std::uint8_t octet) {
    return {(octet & 0x40) != 0, (octet & 0x80) != 0, static_cast<std::uint8_t>(octet & 0x3F)};
}
constexpr std::uint8_t segment_header_octet(const SegmentHeader& header) {
    return static_cast<std::uint8_t>((header.last ? 0x80 : 0) | (header.first ? 0x40 : 0) |
                                     (header.pseudo_packet & 0x3F));
}

}  // namespace aeolis
