// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "common/fixed_vector.hpp"
#include "common/space_packet.hpp"
#include "flight/edl_comm/telemetry_plan.hpp"
#include "flight/kernel/message.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace aeolis::flight {

inline constexpr std::size_t telemetry_packet_octets_max = tm_overhead_octets + record_octets_max;

/// A sealed packet, as it was recorded.
struct TelemetryPacket {
    std::uint16_t size = 0;
    std::array<std::uint8_t, telemetry_packet_octets_max> octets{};
    std::span<const std::uint8_t> span() const { return std::span{octets}.first(size); }
};

/// What was chosen for the link and waits for it. The most important go first, of equals the oldest. R30
///
/// Memory   192 packets (ours: at 8 kb/s some 20 s of the link). When all are taken the least important gives way, of
///          equals the oldest: old real time is worth least; a newcomer less important than all that wait does not
///          enter.
/// Nothing is lost by that but real time: what is here is in the recording already.
class RealtimeQueue {
  public:
    static constexpr std::size_t packets_max = 192;

    RealtimeQueue();

    /// False when a packet had to go for it, or it itself.
    bool offer(const TelemetryPacket& packet, TelemetryPriority priority);

    bool empty() const { return waiting() == 0; }
    /// The packet to be sent next; there is one.
    const TelemetryPacket& front() const;
    void pop();

    std::size_t waiting() const { return packets_max - free_.size(); }
    std::uint32_t waiting_octets(TelemetryPriority priority) const { return waiting_octets_[index(priority)]; }
    std::uint32_t waiting_octets() const;
    std::uint32_t dropped(TelemetryPriority priority) const { return dropped_[index(priority)]; }
    std::uint32_t dropped() const;

  private:
    using Slot = std::uint8_t;
    static_assert(packets_max <= 256);
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
