// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"
#include "telemetry/port.hpp"
#include "telemetry/station/link_ledger.hpp"
#include "telemetry/station/received.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// A packet source, and the layout that was recognised, in words; empty: none had to be.
struct RecognisedSource {
    PacketSource source;
    std::string layout;
};

/// Receives the link of another mission: finds the packets in its octets, in the same way for a line and a recording.
///
/// In       the port's deliveries, octets in pieces of any size; where a stream ends
/// Out      octets and packets in the order of reception, packets with the time at which what completed them was
///          received; totals of the link over all its streams
/// Layout   recognised by the first octets of each stream; tried again whenever these have doubled
/// Datagrams  each holds whole packets, whole frames, or a piece of a stream, as the format has it
/// Memory   a frame or a packet, and the beginning of a stream until its layout is recognised
/// Faults   octets that are not packets are counted. A beginning that reveals no layout is not read; it is counted
class ForeignStation {
  public:
    static constexpr std::size_t beginning_octets_max = std::size_t{1} << 20U;  ///< chosen: two frames of any length

    /// Makes the source of a stream from its first octets, or says why they reveal no layout. `ended`: no more come.
    using Recognise = std::function<Result<RecognisedSource>(std::span<const std::uint8_t> beginning, bool ended)>;

    explicit ForeignStation(Recognise recognise) : recognise_(std::move(recognise)) {}

    /// Recognises the layout of a recording in advance, from its first octets, which are received afterwards.
    Result<void> recognise(std::span<const std::uint8_t> beginning, bool ended);
    /// Processes a delivery. The result is valid until the next call, and until then the caller's to move from.
    Received& receive(Downlink downlink);
    /// Ends the stream: the line broke, or the recording is over. Later octets belong to another stream. The result is
    /// valid as that of receive().
    Received& end(Ert now);

    /// Whether bare packets lost their boundaries, so that none can follow in this stream.
    bool lost() const { return source_ && source_->lost(); }
    /// Layouts recognised since the last call, in words; empty: none.
    std::string take_layout() { return std::exchange(layout_, {}); }
    struct Unread {
        std::size_t octets = 0;
        std::string why;
    };
    /// A beginning that was given up since the last call, and why.
    std::optional<Unread> take_unread() { return std::exchange(unread_, {}); }

    /// The link's totals, with only those sequences that changed since the last call.
    LinkTotals totals(Ert now) { return ledger_.totals(source_ ? &*source_ : nullptr, now); }
    LinkLedger& ledger() { return ledger_; }
    /// Octets of ended streams, between frames or PLTUs, that are not fill.
    std::uint64_t stray_octets() const { return stray_octets_; }

  private:
    struct Piece {
        std::size_t octets = 0;
        Ert ert;
        bool datagram = false;
    };
    void receive(const ReceivedOctets& piece);
    /// Adds the piece to the beginning.
    void begin(const ReceivedOctets& piece);
    void read_beginning(bool ended);
    void read(std::span<const std::uint8_t> octets, Ert ert, bool datagram);
    void take_packets();

    Recognise recognise_;
    std::optional<PacketSource> source_;   ///< of this stream; none: its layout is not recognised yet
    std::vector<std::uint8_t> beginning_;  ///< of a stream without a source
    std::vector<Piece> pieces_;  ///< of the beginning: a datagram each, or a stretch of the stream that came at once
    std::size_t tried_octets_ = 0;
    std::string layout_;
    std::optional<Unread> unread_;
    LinkLedger ledger_{downlink_link.name};
    std::uint64_t stray_octets_ = 0;
    Received received_;
};

}  // namespace aeolis::telemetry
