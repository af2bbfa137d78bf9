// SPDX-License-Identifier: Apache-2.0
#include "simulation/buses/device_faults.hpp"

#include <cmath>

namespace aeolis::simulation {

void DeviceFaults::at(Sclk now) {
    if (faults_.empty()) return;
    states_ = {};
    const double to_entry_s = entry_ - now;
    for (const DeviceFault& fault : faults_) {
        if (to_entry_s > fault.begin_before_entry_s || to_entry_s <= fault.begin_before_entry_s - fault.duration_s)
            continue;
        State& state = states_[static_cast<std::size_t>(fault.device)][static_cast<std::size_t>(fault.unit)];
        state.kinds |= bit(fault.kind);
        if (fault.kind == DeviceFault::Kind::late) state.late_ticks = std::llround(fault.late_s * 64.0);
    }
}

}  // namespace aeolis::simulation
