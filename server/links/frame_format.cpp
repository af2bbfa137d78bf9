// SPDX-License-Identifier: Apache-2.0
#include "server/links/frame_format.hpp"

namespace aeolis::server {
namespace {

using telemetry::DownlinkFormat;

/// The frame layout, from the user's options and the first octets.
Result<telemetry::FrameStream> frame_stream(const PacketStreamFormat& format, DownlinkFormat kind,
                                            std::span<const std::uint8_t> beginning) {
    telemetry::FrameStream stream;
    if (kind == DownlinkFormat::cadu) {
        const auto found = telemetry::recognise_cadus(beginning);
        if (!found && !format.frame_octets) return Error{"no two sync markers 1ACFFC1D: say --frame-octets"};
        if (found) stream = *found;
    } else {
        stream.kind = kind == DownlinkFormat::tm ? telemetry::FrameStream::Kind::tm : telemetry::FrameStream::Kind::aos;
        stream.marker = false;
        stream.prefix_octets = format.skip;
        const auto found = telemetry::crc_frame_octets(beginning, format.skip);
        if (!found && !format.frame_octets)
            return Error{"frames of no length end with a right CRC-16: say --frame-octets"};
        stream.agreed.crc = found.has_value();
        stream.frame_octets = found.value_or(stream.frame_octets);
    }
    if (format.frame_octets && *format.frame_octets != stream.frame_octets) {
        stream.frame_octets = *format.frame_octets;
        stream.suffix_octets = 0;
    }
    return stream;
}

}  // namespace

Result<telemetry::PacketSource> packet_source(const PacketStreamFormat& format,
                                              std::span<const std::uint8_t> beginning) {
    const auto kind = telemetry::downlink_format(format.name);
    if (!kind) return Error{"there is no format '" + format.name + "': packets, tm, aos, cadu or pltu"};
    if (*kind == DownlinkFormat::packets) return telemetry::PacketSource::of_packets(format.skip);
    if (*kind == DownlinkFormat::pltu) return telemetry::PacketSource::of_pltus();
    const auto frames = frame_stream(format, *kind, beginning);
    if (!frames) return frames.error();
    return telemetry::PacketSource::of_frames(*frames);
}

bool needs_beginning(const PacketStreamFormat& format) {
    const auto kind = telemetry::downlink_format(format.name);
    return kind && *kind != DownlinkFormat::packets && *kind != DownlinkFormat::pltu;
}

}  // namespace aeolis::server
