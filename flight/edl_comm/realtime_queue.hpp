// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "common/fixed_vector.hpp"
#include "common/space_packet.hpp"
#include "flight/edl_comm/telemetry_plan.hpp"
#include "flight/kernel/message.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace aeolis::flight {

inline constexpr std::size_t telemetry_packet_octets_max = tm_overhead_octets + record_octets_max;

/// A sealed packet, as it was recorded.
struct TelemetryPacket {
    std::uint16_t size = 0;
    std::array<std::uint8_t, telemetry_packet_octets_max> octets{};
    std::span<const std::uint8_t> span() const { return std::span{octets}.first(size); }
};

/// Packets selected for the link and waiting for it.
/// The most important go first; among equals, the oldest. R30
///
/// Memory   192 packets (chosen: about 20 s of the link at 8 kb/s). When full, the least important is dropped, among
///          equals the oldest, because old real-time data is worth least. A packet less important than all that wait is
///          not queued.
/// Only real-time data is lost by a drop: every packet here has already been recorded.
class RealtimeQueue {
  public:
    static constexpr std::size_t packets_max = 192;

    RealtimeQueue();

    /// Queues the packet. False when another packet, or this one, had to be dropped.
    bool offer(const TelemetryPacket& packet, TelemetryPriority priority);

    bool empty() const { return waiting() == 0; }
    /// The next packet to send; the queue must not be empty.
    const TelemetryPacket& front() const;
    void pop();

    std::size_t waiting() const { return packets_max - free_.size(); }
    std::uint32_t waiting_octets(TelemetryPriority priority) const { return waiting_octets_[index(priority)]; }
    std::uint32_t waiting_octets() const;
    std::uint32_t dropped(TelemetryPriority priority) const { return dropped_[index(priority)]; }
    std::uint32_t dropped() const;

  private:
    using Slot = std::uint8_t;
    static_assert(packets_max <= std::numeric_limits<Slot>::max() + 1);
    static constexpr std::size_t index(TelemetryPriority priority) { return static_cast<std::size_t>(priority); }
    std::size_t most_important() const;
    void release_oldest(std::size_t priority);

    std::array<TelemetryPacket, packets_max> packets_{};
    std::array<FixedQueue<Slot, packets_max>, telemetry_priorities> waiting_;
    FixedVector<Slot, packets_max> free_;
    std::array<std::uint32_t, telemetry_priorities> waiting_octets_{};
    std::array<std::uint32_t, telemetry_priorities> dropped_{};
};

}  // namespace aeolis::flight
