// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/proximity_frame.hpp"
#include "telemetry/frame_order.hpp"
#include "telemetry/octet_window.hpp"
#include "telemetry/stray_octets.hpp"
#include "telemetry/sync_search.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Finds Proximity-1 frames in a stream of octets.
///
/// In       octets as received, in pieces of any size       Out   frames with a right CRC, and the place of each in the
///          sequence of its spacecraft, channel and service. Repeated ones are only counted
/// Rate     above 200 MB/s (bench/pltu_bench.cpp)
/// Memory   the last piece, one PLTU, and until the first frame the octets before it, `first_octets_max` at most
/// Sync     markers are searched at every bit, inverted too. At another bit than the frame before, only a right CRC
///          makes a frame, and nothing else is counted
/// Faults   after anything but a good frame the search continues right behind the marker, so that a good frame is never
///          lost to a bad one before it, even when a damaged length spans it
class PltuReceiver {
  public:
    struct Received {
        ProximityFrame frame;  ///< valid until the next next() or receive()
        FramePlace place = FramePlace::next;
    };

    void receive(std::span<const std::uint8_t> octets);

    /// The next frame; none when more octets are needed.
    std::optional<Received> next();

    /// Marks a pause or the end of the stream: next() then searches an incomplete frame too, until more octets arrive.
    void end() { ended_ = true; }

    LinkCounters counters() const;
    /// Skipped octets that are not fill.
    std::uint64_t stray_octets() const;
    /// Totals of each spacecraft, channel and service.
    std::vector<SequenceTotals> sequences() const;

  private:
    static constexpr std::size_t first_octets_max = std::size_t{1} << 16U;  ///< chosen: a minute of fill at 8 kbit/s

    void skip(std::size_t octets);
    void skip_to_stray(std::size_t octets);
    void begin_alignment(const BitAlignment& alignment);

    OctetWindow window_;
    BitAlignment alignment_;           ///< of the last good frame
    std::vector<std::uint8_t> first_;  ///< octets skipped before the first frame, which shows how bits lie in them
    bool aligned_ = false;             ///< those are counted
    std::vector<std::uint8_t> pltu_;   ///< as it was sent, where octets as received are not
    struct Stream {
        FrameOrder order;
        SequenceCounters counters;
    };
    std::map<std::uint32_t, Stream> streams_;
    StrayOctets stray_;
    LinkCounters counters_;  ///< without the sequences of streams_
    bool ended_ = false;
};

}  // namespace aeolis::telemetry
