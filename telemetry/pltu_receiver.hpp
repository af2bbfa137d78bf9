// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/proximity_frame.hpp"
#include "telemetry/frame_order.hpp"
#include "telemetry/octet_window.hpp"
#include "telemetry/stray_octets.hpp"

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
/// Memory   the last piece and one PLTU
/// Faults   after anything but a good frame the search continues right behind the marker, so that a good frame is never
///          lost to a bad one before it, even when a damaged length spans it
class PltuReceiver {
  public:
    struct Received {
        ProximityFrame frame;  ///< valid until the next receive()
        FramePlace place = FramePlace::next;
    };

    void receive(std::span<const std::uint8_t> octets);

    /// The next frame; none when more octets are needed.
    std::optional<Received> next();

    /// Marks a pause or the end of the stream: next() then searches an incomplete frame too, until more octets arrive.
    void end() { ended_ = true; }

    LinkCounters counters() const;
    /// Skipped octets that are not fill.
    std::uint64_t stray_octets() const { return stray_.number(); }
    /// Totals of each spacecraft, channel and service.
    std::vector<SequenceTotals> sequences() const;

  private:
    void skip(std::size_t octets);

    OctetWindow window_;
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
