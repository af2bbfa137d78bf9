// SPDX-License-Identifier: Apache-2.0
// A stream of TM or AOS frames of any octets, with markers or without, and the packets in them. The first octets choose
// how the stream is read; where a CRC is agreed, the rest is cut into frames whose CRC is right.
#include "common/crc.hpp"
#include "telemetry/frame_receiver.hpp"
#include "telemetry/packet_extractor.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace aeolis;
    using namespace aeolis::telemetry;
    if (size < 4) return 0;
    FrameStream how;
    how.kind = (data[0] & 1) != 0 ? FrameStream::Kind::aos : FrameStream::Kind::tm;
    how.marker = (data[0] & 2) != 0;
    how.randomised = (data[0] & 4) != 0;
    how.agreed = {.crc = (data[0] & 8) != 0,
                  .control_field = (data[0] & 16) != 0,
                  .header_error_control = (data[2] & 128) != 0,
                  .insert_octets = static_cast<std::uint8_t>(data[0] >> 5)};
    how.frame_octets = 9 + data[1];
    if (how.marker) how.alignment = {(data[2] & 7U), (data[2] & 8U) != 0};
    if (how.marker && data[1] % 4 == 0) {
        how.code = ReedSolomonCode{.check_symbols = 16, .interleave = 1};
        how.frame_octets = std::min<std::size_t>(how.frame_octets, 239);
        how.suffix_octets = how.code->check_octets();
    }
    how.prefix_octets = how.marker ? 0 : data[2] % 8;
    const std::size_t piece = data[3] + std::size_t{1};
    const std::span<const std::uint8_t> given{data + 4, size - 4};

    std::vector<std::uint8_t> stream;
    if (how.agreed.crc && !how.randomised) {
        for (std::size_t at = 0; at < given.size(); at += how.frame_octets - 2) {
            if (how.marker) stream.insert(stream.end(), attached_sync_marker.begin(), attached_sync_marker.end());
            stream.resize(stream.size() + how.prefix_octets);
            std::vector<std::uint8_t> frame(how.frame_octets);
            std::copy_n(given.begin() + static_cast<std::ptrdiff_t>(at),
                        std::min(how.frame_octets - 2, given.size() - at), frame.begin());
            const std::uint16_t crc = crc16(std::span{frame}.first(frame.size() - 2));
            frame[frame.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
            frame[frame.size() - 1] = static_cast<std::uint8_t>(crc & 0xFF);
            stream.insert(stream.end(), frame.begin(), frame.end());
        }
    } else {
        stream.assign(given.begin(), given.end());
    }

    FrameReceiver receiver{how};
    PacketExtractor packets;
    const std::size_t unit = how.frame_octets + how.suffix_octets + (how.marker ? 4 : how.prefix_octets);
    for (std::size_t at = 0; at < stream.size(); at += piece) {
        receiver.receive(std::span{stream}.subspan(at, std::min(piece, stream.size() - at)));
        while (const auto received = receiver.next()) {
            packets.add(received->frame, received->place);
            while (const auto packet = packets.next())
                if (packet->size() <= 6) std::abort();
        }
    }
    receiver.end();
    packets.end();
    if (receiver.counters().frames * unit + receiver.counters().skipped_octets != stream.size()) std::abort();
    (void)cadu_frame_octets(stream);
    (void)crc_frame_octets(stream, how.prefix_octets, true);
    (void)recognise_cadus(stream, {}, true);
    return 0;
}
