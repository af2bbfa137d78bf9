// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "flight/kernel/message.hpp"
#include "generated/owners.hpp"

#include <span>
#include <type_traits>

namespace aeolis::flight {

/// Converts to the precision of packets and events.
constexpr float single(double value) {
    return static_cast<float>(value);
}

/// Collects the messages that a module sends while it handles one message.
/// Sending returns nothing (R6): the executive counts and reports messages lost to a full outbox or mailbox.
class Outbox {
  public:
    /// Empties the outbox for the next message that `from` handles.
    void begin(ModuleId from, Sclk now, DeviceOutputs& bus) {
        from_ = from;
        now_ = now;
        bus_ = &bus;
        sent_.clear();
        dropped_ = 0;
    }

    template <typename M>
    void send(ModuleId to, const M& message) {
        Envelope* const place = sent_.try_grow();
        if (place == nullptr) {
            ++dropped_;
            return;
        }
        place->from = from_;
        place->to = to;
        place->message.emplace<M>(message);
    }

    /// Sends an event report: recorded, and sent to ground by the telemetry plan. R29, R30
    template <typename Evr>
    void event(const Evr& evr) {
        record(evr);
    }

    /// Sends one telemetry packet of the dictionary to EdlComm.
    template <typename Packet>
    void record(const Packet& packet) {
        static_assert(Packet::octets - tm_overhead_octets <= record_octets_max);
        // Only the one module that may make a decision explains it. R5
        if constexpr (std::is_same_v<Packet, packet::Explanation>) AEOLIS_CHECK(owner_of(packet.decision) == from_);
        Record record{Packet::apid, now_, static_cast<std::uint16_t>(Packet::octets - tm_overhead_octets), {}};
        BitWriter writer{std::span{record.data}.first(record.size)};
        packet.encode(writer);
        send(ModuleId::edl_comm, record);
    }

    Sclk now() const { return now_; }
    ModuleId from() const { return from_; }

    /// Outputs to the hardware. Only the module that manages a device writes its part. R5
    DeviceOutputs& bus() { return *bus_; }

    std::span<const Envelope> sent() const { return sent_.span(); }
    std::uint32_t dropped() const { return dropped_; }

  private:
    // The busiest handler is Edl's tick: five timepoints with an event, a tone and a record each, and telemetry.
    static constexpr std::size_t capacity = 64;

    ModuleId from_{};
    Sclk now_;
    DeviceOutputs* bus_ = nullptr;  // the caller's, valid for one step
    FixedVector<Envelope, capacity> sent_;
    std::uint32_t dropped_ = 0;
};

}  // namespace aeolis::flight
