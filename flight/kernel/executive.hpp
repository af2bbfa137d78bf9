#pragma once

#include "flight/computer_state.hpp"

namespace aeolis::flight {

/// The deterministic executive: runs the modules of a computer in one thread, always the one of highest priority that
/// has mail, one message at a time, until all mailboxes are empty.
///
/// What a module outside the rate group sends is kept for the start of the next cycle, so that the order in which such
/// modules happen to run cannot be seen. (docs/decisions/0003-deterministic-executive.md)
class Executive {
  public:
    explicit Executive(ComputerState& state) : state_(state) {}

    void cycle(const DeviceInputs& in, DeviceOutputs& out);

  private:
    void post_interrupts(const DeviceInputs& in);
    void deliver(ModuleId to, const Message& message);
    void dispatch(ModuleId id, const Message& message, DeviceOutputs& out);
    template <typename Module>
    void handle(Module& module, const Message& message);
    void distribute(ModuleId from);

    ComputerState& state_;
};

}  // namespace aeolis::flight
