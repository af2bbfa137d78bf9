// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"

namespace aeolis::flight {

struct ComputerState;

/// How one 64 Hz cycle of a computer's modules is run: the deterministic executive when there is none, else the one
/// that a venue brings (server/venue). Whatever runs them, the modules do the same. R36
///
/// Faults  throws CheckFailed when a module's check failed: the state is of no use then, and the caller makes it anew
class CycleRunner {
  public:
    virtual ~CycleRunner() = default;
    virtual void cycle(ComputerState& state, const DeviceInputs& in, DeviceOutputs& out) = 0;

    /// Ticks of the clock that passed in cycles since the last call, beyond one a cycle: the world has gone on
    /// meanwhile.
    virtual int take_ticks_skipped() { return 0; }
};

}  // namespace aeolis::flight
