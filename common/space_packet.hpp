// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace aeolis {

/// CCSDS space packet, in the layout that our vehicle writes. [ccsds-133.0-b-2]
///
///   primary header 6 octets | telemetry: CUC coarse 4, fine 2, dictionary id 2 | data | CRC-16 2
///                           | telecommand: opcode 2                            | data | CRC-16 2
inline constexpr std::size_t primary_header_octets = 6;
inline constexpr std::size_t tm_secondary_header_octets = 8;
inline constexpr std::size_t tm_data_offset_octets = primary_header_octets + tm_secondary_header_octets;
inline constexpr std::size_t packet_crc_octets = 2;
inline constexpr std::size_t tm_overhead_octets = tm_data_offset_octets + packet_crc_octets;
inline constexpr std::size_t packet_octets_max = 1024;  ///< chosen: one packet fits one message of the recorder

inline constexpr std::uint16_t packet_count_mask = 0x3FFF;  ///< its 14 bits

struct PrimaryHeader {
    bool telecommand = false;
    bool secondary_header = true;
    Apid apid;
    std::uint16_t count = 0;   ///< 14 bits, per APID
    std::uint16_t length = 0;  ///< octets after the primary header, less one

    constexpr std::size_t packet_octets() const { return primary_header_octets + length + std::size_t{1}; }
    constexpr auto operator<=>(const PrimaryHeader&) const = default;
};

/// Length in octets of the space packet that begins `octets`, from any sender, segmented or not.
/// None when its header is incomplete or of another version.
std::optional<std::size_t> space_packet_octets(std::span<const std::uint8_t> octets);
inline constexpr std::size_t space_packet_octets_max = primary_header_octets + 65536;
inline constexpr std::uint16_t idle_apid = 0x7FF;
inline constexpr Apid file_delivery_apid{0x7FD};  ///< packets whose data are a CFDP PDU; 2045, the APID reserved for
                                                  ///< CFDP
/// Whether ground itself makes packets of this APID, from its station's measurements; no vehicle sends them. The range
/// is chosen: beside CFDP's APID.
constexpr bool is_made_on_ground(Apid apid) {
    return apid.value >= 0x7E0 && apid.value <= 0x7EF;
}
inline constexpr Apid station_carrier_apid{0x7E0}, station_event_apid{0x7E1}, station_spectrum_apid{0x7E2};

/// The packet that begins a run of octets. Beside space packets, frames may carry encapsulation packets, of one octet
/// or more. [ccsds-133.0-b-2] [ccsds-133.1-b-3]
struct PacketStart {
    enum class Kind : std::uint8_t {
        space,
        idle,           ///< a space packet of the idle APID, or an encapsulation packet of protocol 0
        encapsulation,  ///< of another protocol
        unknown,        ///< not a packet, or one of another version
    };
    Kind kind = Kind::unknown;
    std::size_t octets = 0;  ///< of the whole packet; 0: its header is not complete
};
/// Recognises the packet that begins `octets`, which must not be empty.
PacketStart packet_start(std::span<const std::uint8_t> octets);
inline constexpr std::size_t encapsulation_octets_max = std::size_t{1} << 20U;  ///< chosen; a longer one is unknown

/// Writes the header of an unsegmented packet into the first six octets.
void write_primary_header(const PrimaryHeader& header, std::span<std::uint8_t> packet);

struct TmHeader {
    PrimaryHeader primary;
    Sclk time;  ///< CUC 4+2 octets, agency epoch; 1/65536 s holds 1/64 s exactly
    std::uint16_t dictionary_id = 0;
};

/// Reads the primary header. None when `octets` are too short, of another version, or segmented.
std::optional<PrimaryHeader> read_primary_header(std::span<const std::uint8_t> octets);

/// Reads the headers of a whole telemetry packet.
/// None when the length field disagrees with the octets or the CRC is wrong.
std::optional<TmHeader> read_tm_packet(std::span<const std::uint8_t> packet);

/// Writes both headers and the CRC around data that is already in place at `tm_data_offset_octets`.
/// `packet` spans the whole packet: tm_overhead_octets + data.
void seal_tm_packet(std::span<std::uint8_t> packet, Apid apid, std::uint16_t count, Sclk time,
                    std::uint16_t dictionary_id);

/// Offset of a telecommand packet's arguments: after the primary header and the opcode.
inline constexpr std::size_t tc_arguments_offset_octets = primary_header_octets + 2;
inline constexpr std::size_t tc_overhead_octets = tc_arguments_offset_octets + packet_crc_octets;
/// Writes header, opcode and CRC around arguments already in place at `tc_arguments_offset_octets`.
void seal_tc_packet(std::span<std::uint8_t> packet, Apid apid, std::uint16_t count, Opcode opcode);

struct TcPacket {
    PrimaryHeader primary;
    Opcode opcode;
    std::span<const std::uint8_t> arguments;
};
/// Reads a telecommand packet. None unless it is whole and unsegmented and has a correct CRC.
std::optional<TcPacket> read_tc_packet(std::span<const std::uint8_t> packet);

}  // namespace aeolis
