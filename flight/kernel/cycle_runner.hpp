// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"

namespace aeolis::flight {

struct ComputerState;

/// Runs one 64 Hz cycle of a computer's modules, in place of the deterministic executive.
/// Implemented by a venue (server/venue). Under every runner, the modules behave identically. R36
///
/// Faults  throws CheckFailed when a module's check failed: the state is then unusable, and the caller makes it anew
class CycleRunner {
  public:
    virtual ~CycleRunner() = default;
    virtual void cycle(ComputerState& state, const DeviceInputs& in, DeviceOutputs& out) = 0;

    /// Clock ticks lost to long cycles since the last call: the world has advanced by these meanwhile.
    virtual int take_ticks_skipped() { return 0; }
};

}  // namespace aeolis::flight
