// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/frame_receiver.hpp"
#include "telemetry/proximity_packets.hpp"
#include "telemetry/segment_assembler.hpp"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace aeolis::telemetry {

enum class DownlinkFormat : std::uint8_t { packets, tm, aos, cadu, pltu };
std::optional<DownlinkFormat> downlink_format(std::string_view name);

/// Contiguous space packets, each after `prefix_octets` that are ignored.
///
/// Faults   where no valid header stands it ends: there is no mark to find the next packet by
class BarePackets {
  public:
    explicit BarePackets(std::size_t prefix_octets) : prefix_octets_(prefix_octets) {}
    void receive(std::span<const std::uint8_t> octets) { window_.add(octets); }
    std::optional<std::span<const std::uint8_t>> next();
    /// Ends the stream.
    void end();
    /// Ends a datagram: the next octets begin with a packet, whatever stands before them.
    void end_datagram();
    bool lost() const { return lost_; }
    const PacketCounters& counters() const { return counters_; }

  private:
    std::size_t prefix_octets_;
    OctetWindow window_;
    PacketCounters counters_;
    bool lost_ = false;
};

/// Extracts space packets of any mission from a stream in any of the formats.
///
/// In       octets as received, in pieces of any size       Out   packets, in the order of completion; what was sent in
///          segments as one
class PacketSource {
  public:
    static PacketSource of_packets(std::size_t prefix_octets) { return PacketSource{BarePackets{prefix_octets}}; }
    static PacketSource of_frames(const FrameStream& stream) { return PacketSource{Frames{FrameReceiver{stream}, {}}}; }
    static PacketSource of_pltus() { return PacketSource{Pltus{}}; }

    void receive(std::span<const std::uint8_t> octets);
    /// Ends the stream; next() may then return more packets.
    void end();
    /// Ends a datagram, which holds whole packets or frames.
    void end_datagram();
    /// The next packet; valid until the next call of any function.
    std::optional<std::span<const std::uint8_t>> next();

    /// Whether bare packets lost their boundaries, so that none can follow.
    bool lost() const;
    LinkCounters link() const;  ///< of frames; zero for bare packets
    PacketCounters packets() const;

  private:
    struct Frames {
        FrameReceiver receiver;
        std::map<std::uint32_t, PacketExtractor> channels;  ///< by spacecraft and virtual channel
    };
    struct Pltus {
        PltuReceiver receiver;
        ProximityPackets packets;
    };
    using Source = std::variant<BarePackets, Frames, Pltus>;
    explicit PacketSource(Source source) : source_(std::move(source)) {}
    void take_from(Frames& frames);
    void take_from(Pltus& pltus);
    void take_from(BarePackets& packets);
    void keep(std::span<const std::uint8_t> packet);

    Source source_;
    SegmentAssembler segments_;
    std::deque<std::vector<std::uint8_t>> whole_;
    std::vector<std::uint8_t> given_;
};

}  // namespace aeolis::telemetry
