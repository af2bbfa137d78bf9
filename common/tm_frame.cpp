// SPDX-License-Identifier: Apache-2.0
#include "common/tm_frame.hpp"

#include "common/aos_header.hpp"
#include "common/bytes.hpp"
#include "common/crc.hpp"

#include <algorithm>

namespace aeolis {
namespace {

constexpr std::size_t transfer_header_octets = 6;
constexpr std::size_t packet_zone_header_octets = 2;
constexpr std::size_t control_field_octets = 4;
constexpr std::size_t transfer_crc_octets = 2;
constexpr std::size_t header_error_control_octets = 2;

/// The octets after the header, without CRC and control field; the control field is stored in `into`.
/// @param header  the frame's first octets, as corrected
Parsed<std::span<const std::uint8_t>> body_of(std::span<const std::uint8_t> frame, std::span<const std::uint8_t> header,
                                              bool crc, bool control_field, TransferFrame& into) {
    if (crc && crc16(frame.subspan(header.size()), crc16(header)) != 0) return Malformed::bad_checksum;
    const std::size_t after = (crc ? transfer_crc_octets : 0) + (control_field ? control_field_octets : 0);
    if (frame.size() <= transfer_header_octets + after) return Malformed::too_short;
    const auto body = frame.subspan(transfer_header_octets, frame.size() - transfer_header_octets - after);
    if (control_field)
        into.control_field =
            static_cast<std::uint32_t>(read_bits(frame, (transfer_header_octets + body.size()) * 8, 32));
    return body;
}

Malformed check_size(std::span<const std::uint8_t> frame) {
    if (frame.size() <= transfer_header_octets + transfer_crc_octets) return Malformed::too_short;
    return frame.size() > transfer_frame_octets_max ? Malformed::too_long : Malformed::none;
}

Malformed check_pointer(const TransferFrame& frame) {
    const bool inside = frame.first_header_pointer < frame.data.size();
    return inside || frame.first_header_pointer >= only_idle_data ? Malformed::none : Malformed::bad_field;
}

void close_frame(const TransferFrame& frame, std::size_t data_offset, bool crc, std::span<std::uint8_t> into) {
    const std::size_t after = (crc ? transfer_crc_octets : 0) + (frame.control_field ? control_field_octets : 0);
    AEOLIS_CHECK(into.size() == data_offset + frame.data.size() + after && !frame.data.empty());
    const auto end =
        std::copy(frame.data.begin(), frame.data.end(), into.begin() + static_cast<std::ptrdiff_t>(data_offset));
    if (frame.control_field)
        for (std::size_t i = 0; i < control_field_octets; ++i)
            *(end + static_cast<std::ptrdiff_t>(i)) = static_cast<std::uint8_t>(*frame.control_field >> (24 - 8 * i));
    if (!crc) return;
    const std::uint16_t word = crc16(into.first(into.size() - transfer_crc_octets));
    into[into.size() - 2] = static_cast<std::uint8_t>(word >> 8);
    into[into.size() - 1] = static_cast<std::uint8_t>(word & 0xFF);
}

}  // namespace

Parsed<TransferFrame> read_tm_frame(std::span<const std::uint8_t> octets, const FrameAgreement& agreed) {
    if (const Malformed why = check_size(octets); why != Malformed::none) return why;
    BitReader reader{octets};
    if (reader.get(2) != 0) return Malformed::other_version;
    TransferFrame frame;
    frame.spacecraft = static_cast<std::uint16_t>(reader.get(10));
    frame.virtual_channel = static_cast<std::uint8_t>(reader.get(3));
    const bool control_field = reader.get(1) != 0;
    reader.get(8);
    frame.count = static_cast<std::uint32_t>(reader.get(8));
    const bool secondary_header = reader.get(1) != 0;
    frame.packets = reader.get(1) == 0;
    reader.get(3);
    frame.first_header_pointer = static_cast<std::uint16_t>(reader.get(11));
    const auto body = body_of(octets, {}, agreed.crc, control_field, frame);
    if (!body) return body.why();
    // The first octet of the secondary header gives the number of octets after it, in six bits.
    const std::size_t skipped = secondary_header ? ((*body)[0] & 0x3FU) + std::size_t{1} : 0;
    if (skipped >= body->size()) return Malformed::bad_field;
    frame.data = body->subspan(skipped);
    if (const Malformed why = check_pointer(frame); frame.packets && why != Malformed::none) return why;
    return frame;
}

Parsed<TransferFrame> read_aos_frame(std::span<const std::uint8_t> octets, const FrameAgreement& agreed) {
    if (const Malformed why = check_size(octets); why != Malformed::none) return why;
    AosHeader header{};
    std::copy_n(octets.begin(), header.size(), header.begin());
    TransferFrame frame;
    if (agreed.header_error_control) {
        const auto corrected = correct_aos_header(header);
        if (!corrected) return Malformed::bad_field;
        frame.corrected_symbols = *corrected;
    }
    BitReader reader{header};
    if (reader.get(2) != 1) return Malformed::other_version;
    frame.spacecraft = static_cast<std::uint16_t>(reader.get(8));
    frame.virtual_channel = static_cast<std::uint8_t>(reader.get(6));
    frame.count = static_cast<std::uint32_t>(reader.get(24));
    frame.count_modulus = 1U << 24;
    frame.replay = reader.get(1) != 0;
    const auto body = body_of(octets, header, agreed.crc, agreed.control_field, frame);
    if (!body) return body.why();
    const std::size_t before = (agreed.header_error_control ? header_error_control_octets : 0) + agreed.insert_octets;
    if (body->size() <= before + packet_zone_header_octets) return Malformed::too_short;
    const auto zone = body->subspan(before);
    frame.first_header_pointer = static_cast<std::uint16_t>(read_bits(zone, 5, 11));
    frame.data = zone.subspan(packet_zone_header_octets);
    if (const Malformed why = check_pointer(frame); why != Malformed::none) return why;
    return frame;
}

void write_tm_frame(const TransferFrame& frame, std::uint8_t master_count, bool crc, std::span<std::uint8_t> into) {
    AEOLIS_CHECK(frame.spacecraft < 1024 && frame.virtual_channel < 8 &&
                 frame.first_header_pointer <= no_packet_begins);
    std::fill(into.begin(), into.end(), std::uint8_t{0});
    BitWriter writer{into};
    writer.put(0, 2);
    writer.put(frame.spacecraft, 10);
    writer.put(frame.virtual_channel, 3);
    writer.put(frame.control_field.has_value(), 1);
    writer.put(master_count, 8);
    writer.put(frame.count & 0xFF, 8);
    writer.put(0b000'11, 5);
    writer.put(frame.first_header_pointer, 11);
    close_frame(frame, transfer_header_octets, crc, into);
}

void write_aos_frame(const TransferFrame& frame, bool crc, std::span<std::uint8_t> into) {
    AEOLIS_CHECK(frame.spacecraft < 256 && frame.virtual_channel < 64 &&
                 frame.first_header_pointer <= no_packet_begins);
    std::fill(into.begin(), into.end(), std::uint8_t{0});
    BitWriter writer{into};
    writer.put(1, 2);
    writer.put(frame.spacecraft, 8);
    writer.put(frame.virtual_channel, 6);
    writer.put(frame.count & 0xFFFFFF, 24);
    writer.put(frame.replay, 1);
    writer.put(0, 7);
    writer.put(0, 5);
    writer.put(frame.first_header_pointer, 11);
    close_frame(frame, transfer_header_octets + packet_zone_header_octets, crc, into);
}

}  // namespace aeolis
