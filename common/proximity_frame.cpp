// SPDX-License-Identifier: Apache-2.0
#include "common/proximity_frame.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"

#include <algorithm>

namespace aeolis {
namespace {

constexpr unsigned proximity_version = 2;

}  // namespace

Parsed<std::size_t> proximity_frame_octets(std::span<const std::uint8_t> octets) {
    if (octets.size() < proximity_header_octets) return Malformed::too_short;
    if (octets[0] >> 6 != proximity_version) return Malformed::other_version;
    const std::size_t length = (static_cast<std::size_t>(octets[2] & 7) << 8) + octets[3] + 1;
    if (length <= proximity_header_octets) return Malformed::bad_field;
    return length;
}

Parsed<ProximityFrame> read_proximity_frame(std::span<const std::uint8_t> frame) {
    const auto length = proximity_frame_octets(frame);
    if (!length) return length.why();
    if (frame.size() != *length) return frame.size() < *length ? Malformed::too_short : Malformed::too_long;
    BitReader reader{frame};
    reader.get(2);
    ProximityHeader header;
    header.expedited = reader.get(1) != 0;
    header.supervisory = reader.get(1) != 0;
    header.construction = static_cast<Construction>(reader.get(2));
    header.spacecraft = static_cast<std::uint16_t>(reader.get(10));
    header.physical_channel = static_cast<std::uint8_t>(reader.get(1));
    header.port = static_cast<std::uint8_t>(reader.get(3));
    header.to_spacecraft = reader.get(1) != 0;
    reader.get(11);
    header.sequence = static_cast<std::uint8_t>(reader.get(8));
    return ProximityFrame{header, frame.subspan(proximity_header_octets)};
}

Parsed<ProximityFrame> read_pltu(std::span<const std::uint8_t> pltu) {
    if (pltu.size() < pltu_overhead_octets) return Malformed::too_short;
    if (!std::equal(pltu_marker.begin(), pltu_marker.end(), pltu.begin())) return Malformed::no_start;
    const auto frame =
        read_proximity_frame(pltu.subspan(pltu_marker.size(), pltu.size() - pltu_marker.size() - pltu_crc_octets));
    if (!frame) return frame;
    // The remainder over a frame and its own CRC is zero.
    if (crc32_proximity(pltu.subspan(pltu_marker.size())) != 0) return Malformed::bad_checksum;
    return frame;
}

std::size_t write_pltu(const ProximityHeader& header, std::span<const std::uint8_t> data,
                       std::span<std::uint8_t> into) {
    AEOLIS_CHECK(!data.empty() && data.size() <= proximity_data_octets_max);
    AEOLIS_CHECK(into.size() >= pltu_overhead_octets + data.size());
    AEOLIS_CHECK(header.spacecraft < 1024 && header.physical_channel < 2 && header.port < 8);
    const auto pltu = into.first(pltu_overhead_octets + data.size());
    std::copy(pltu_marker.begin(), pltu_marker.end(), pltu.begin());
    const auto frame = pltu.subspan(pltu_marker.size(), proximity_header_octets + data.size());
    std::fill_n(frame.begin(), proximity_header_octets, std::uint8_t{0});
    BitWriter writer{frame};
    writer.put(proximity_version, 2);
    writer.put(header.expedited, 1);
    writer.put(header.supervisory, 1);
    writer.put(static_cast<std::uint8_t>(header.construction), 2);
    writer.put(header.spacecraft, 10);
    writer.put(header.physical_channel, 1);
    writer.put(header.port, 3);
    writer.put(header.to_spacecraft, 1);
    writer.put(frame.size() - 1, 11);
    writer.put(header.sequence, 8);
    std::copy(data.begin(), data.end(), frame.begin() + proximity_header_octets);
    const std::uint32_t crc = crc32_proximity(frame);
    for (std::size_t i = 0; i < pltu_crc_octets; ++i)
        pltu[pltu.size() - pltu_crc_octets + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    return pltu.size();
}

}  // namespace aeolis
