// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/frame_receiver.hpp"
#include "telemetry/proximity_packets.hpp"
#include "telemetry/segment_assembler.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
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
    /// Ends a datagram: the next octets begin with a packet, whatever stands before them. False when octets were left.
    bool end_datagram();
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
    static PacketSource of_frames(const FrameStream& stream) { return PacketSource{Frames{FrameReceiver{stream}}}; }
    static PacketSource of_pltus() { return PacketSource{Pltus{}}; }

    /// @param at  when they were received
    void receive(std::span<const std::uint8_t> octets, Ert at = {});
    /// Ends the stream; next() may then return more packets.
    void end(Ert at = {});
    /// Ends a datagram, which holds whole packets, whole frames without markers, or a piece of a stream of frames with
    /// markers. False when it held anything else.
    bool end_datagram();
    /// The next packet; valid until the next call of any function.
    std::optional<std::span<const std::uint8_t>> next();
    /// When the packet that next() returned last was whole: of frames, the reception of the frame that completed it.
    Ert received() const { return given_.received; }

    /// Whether bare packets lost their boundaries, so that none can follow.
    bool lost() const;
    LinkCounters link() const;  ///< of frames; zero for bare packets
    PacketCounters packets() const;
    /// How first header pointers bear out the packets before them; of frames.
    PointerVerdicts pointers() const;
    /// Octets between frames or PLTUs that are not fill; zero for bare packets, which count them as unreadable.
    std::uint64_t stray_octets() const;
    /// Totals of frames by virtual channel, and of packets by virtual channel and id (APID, type and version). No
    /// counter ever falls: a sequence that is no longer followed keeps its own.
    std::vector<SequenceTotals> sequences() const;
    static constexpr std::size_t packet_ids_followed_max = 4096;  ///< chosen: 1 kB each

  private:
    struct Frames {
        FrameReceiver receiver;
        RecentMap<ChannelNumber, PacketExtractor> channels{channels_followed_max};
        PacketCounters forgotten{};  ///< of channels that were given up
        PointerVerdicts pointers_forgotten{};
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
    /// @param channel  of the frame; none: bare packets, PLTUs
    void keep(std::span<const std::uint8_t> packet, Ert received, std::optional<ChannelNumber> channel = {});
    void keep_all(PacketExtractor& extractor, ChannelNumber channel);

    using PacketKey = std::pair<std::optional<ChannelNumber>, std::uint16_t>;  ///< channel; version, type and APID

    Source source_;
    RecentMap<PacketKey, FrameOrder> packet_orders_{packet_ids_followed_max};
    SequenceTable<PacketKey> packet_ids_;
    SegmentAssembler segments_;
    struct Whole {
        std::vector<std::uint8_t> octets;
        Ert received;
    };
    std::deque<Whole> whole_;
    Whole given_;
    Ert now_;
};

}  // namespace aeolis::telemetry
