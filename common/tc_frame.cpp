// SPDX-License-Identifier: Apache-2.0
#include "common/tc_frame.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"

#include <algorithm>

namespace aeolis {

Parsed<TcFrame> read_tc_frame(std::span<const std::uint8_t> octets) {
    if (octets.size() < tc_frame_overhead_octets) return Malformed::too_short;
    BitReader reader{octets};
    if (reader.get(2) != 0) return Malformed::other_version;
    TcFrameHeader header;
    header.bypass = reader.get(1) != 0;
    header.control = reader.get(1) != 0;
    reader.get(2);
    header.spacecraft = static_cast<std::uint16_t>(reader.get(10));
    header.virtual_channel = static_cast<std::uint8_t>(reader.get(6));
    const std::size_t length = reader.get(10) + 1;
    header.sequence = static_cast<std::uint8_t>(reader.get(8));
    if (length <= tc_frame_overhead_octets) return Malformed::bad_field;
    if (length > octets.size()) return Malformed::too_short;
    const auto frame = octets.first(length);
    if (crc16(frame) != 0) return Malformed::bad_checksum;
    return TcFrame{header, frame.subspan(tc_frame_header_octets, length - tc_frame_overhead_octets)};
}

std::size_t write_tc_frame(const TcFrameHeader& header, std::span<const std::uint8_t> data,
                           std::span<std::uint8_t> into) {
    AEOLIS_CHECK(!data.empty() && data.size() <= tc_frame_data_octets_max);
    AEOLIS_CHECK(into.size() >= data.size() + tc_frame_overhead_octets);
    AEOLIS_CHECK(header.spacecraft < 1024 && header.virtual_channel < 64);
    const auto frame = into.first(data.size() + tc_frame_overhead_octets);
    std::fill_n(frame.begin(), tc_frame_header_octets, std::uint8_t{0});
    BitWriter writer{frame};
    writer.put(0, 2);
    writer.put(header.bypass, 1);
    writer.put(header.control, 1);
    writer.put(0, 2);
    writer.put(header.spacecraft, 10);
    writer.put(header.virtual_channel, 6);
    writer.put(frame.size() - 1, 10);
    writer.put(header.sequence, 8);
    std::copy(data.begin(), data.end(), frame.begin() + tc_frame_header_octets);
    const std::uint16_t crc = crc16(frame.first(frame.size() - tc_frame_crc_octets));
    frame[frame.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
    frame[frame.size() - 1] = static_cast<std::uint8_t>(crc & 0xFF);
    return frame.size();
}

Parsed<Clcw> read_clcw(std::span<const std::uint8_t> octets) {
    if (octets.size() != clcw_octets) return octets.size() < clcw_octets ? Malformed::too_short : Malformed::too_long;
    BitReader reader{octets};
    if (reader.get(1) != 0) return Malformed::bad_field;
    if (reader.get(2) != 0) return Malformed::other_version;
    reader.get(3);
    Clcw clcw;
    clcw.cop = static_cast<std::uint8_t>(reader.get(2));
    clcw.virtual_channel = static_cast<std::uint8_t>(reader.get(6));
    reader.get(2);
    clcw.no_rf = reader.get(1) != 0;
    clcw.no_bit_lock = reader.get(1) != 0;
    clcw.lockout = reader.get(1) != 0;
    clcw.wait = reader.get(1) != 0;
    clcw.retransmit = reader.get(1) != 0;
    clcw.farm_b = static_cast<std::uint8_t>(reader.get(2));
    reader.get(1);
    clcw.expected = static_cast<std::uint8_t>(reader.get(8));
    return clcw;
}

void write_clcw(const Clcw& clcw, std::span<std::uint8_t, clcw_octets> into) {
    AEOLIS_CHECK(clcw.cop < 4 && clcw.virtual_channel < 64 && clcw.farm_b < 4);
    std::fill(into.begin(), into.end(), std::uint8_t{0});
    BitWriter writer{into};
    writer.put(0, 6);
    writer.put(clcw.cop, 2);
    writer.put(clcw.virtual_channel, 6);
    writer.put(0, 2);
    writer.put(clcw.no_rf, 1);
    writer.put(clcw.no_bit_lock, 1);
    writer.put(clcw.lockout, 1);
    writer.put(clcw.wait, 1);
    writer.put(clcw.retransmit, 1);
    writer.put(clcw.farm_b, 2);
    writer.put(0, 1);
    writer.put(clcw.expected, 8);
}

std::uint32_t word_of(const Clcw& clcw) {
    std::array<std::uint8_t, clcw_octets> octets{};
    write_clcw(clcw, octets);
    return static_cast<std::uint32_t>(read_bits(octets, 0, 32));
}

}  // namespace aeolis
