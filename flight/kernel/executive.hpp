// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer_state.hpp"

namespace aeolis::flight {

/// Receives each message that a module has handled; for reports only, never part of a computer.
class MessageTap {
  public:
    virtual ~MessageTap() = default;
    virtual void sent(ModuleId from, ModuleId to, const Message& message) = 0;
};

/// The deterministic executive: runs the modules of a computer in one thread.
/// First the rate group, each module in its turn; then every other module that has messages, in order of priority,
/// until all mailboxes are empty.
///
/// A module of the rate group handles its whole mailbox in its turn, the Tick last. Messages from a module outside the
/// group are held for the start of the next cycle. So results depend neither on the order in which tasks happen to run
/// nor on the number of processors, and the threaded executive gives the same ones.
/// (docs/decisions/0003-deterministic-executive.md)
class Executive {
  public:
    explicit Executive(ComputerState& state, MessageTap* tap = nullptr) : state_(state), tap_(tap) {}

    void cycle(const DeviceInputs& in, DeviceOutputs& out);

    /// Modules that answer one another without end do not hold the computer. Chosen: each module sixty times.
    static constexpr std::size_t runs_per_cycle_max = 60 * module_count;

  private:
    void run(ModuleId id, DeviceOutputs& out);
    template <typename Content>
    void deliver(ModuleId to, const Content& content);
    void distribute(ModuleId from);

    ComputerState& state_;
    MessageTap* tap_;
};

}  // namespace aeolis::flight
