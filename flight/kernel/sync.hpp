// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

#include <array>

namespace aeolis::flight {

/// Drives the hard real-time rate group: runs its modules in a fixed order at each clock tick. R22
///
/// Each module gets its turn whatever its state, and only after the previous one has confirmed.
///
/// In       ClockTick (64 Hz), Confirm           Out   Tick to each module in order; SyncStatus at 1 Hz
/// Faults   a tick before the last module has confirmed is an overrun: counted and reported (CYCLE_OVERRUN), and that
///          cycle is skipped. SCLK continues, because the tick carries it. Messages lost to full mailboxes are reported
///          with their number in the next cycle (MAILBOX_OVERFLOW)
class Sync {
  public:
    explicit Sync(const Load&) {}

    void on(const ClockTick& tick, Outbox& out);
    void on(const Confirm& confirm, Outbox& out);

    std::uint64_t cycles() const { return cycles_; }
    std::uint64_t overruns() const { return overruns_; }
    /// Takes the executive's counts, for the status packet.
    void set_executive_counts(std::uint32_t mailbox_overflows, std::uint32_t unexpected_messages) {
        mailbox_overflows_ = mailbox_overflows;
        unexpected_messages_ = unexpected_messages;
    }

  private:
    static constexpr std::array<ModuleId, 6> order{
        ModuleId::radar, ModuleId::imu, ModuleId::edl, ModuleId::pyro, ModuleId::descent_engines, ModuleId::thrusters};
    static constexpr std::size_t idle = order.size();

    std::size_t running_ = idle;  // index in `order` of the module whose confirmation is awaited
    Sclk now_;
    std::uint64_t cycles_ = 0;
    std::uint64_t overruns_ = 0;
    std::uint32_t mailbox_overflows_ = 0;
    std::uint32_t overflows_told_ = 0;
    std::uint32_t unexpected_messages_ = 0;
};

}  // namespace aeolis::flight
