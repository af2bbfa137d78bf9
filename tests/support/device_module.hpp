// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/outbox.hpp"

namespace aeolis::test {

/// One module, driven by messages; `recorder` holds what the last message made it send.
template <typename Module>
struct Spoken {
    flight::ModuleId id;
    Module module{flight::Load{}};
    OutboxRecorder recorder{};

    template <typename M>
    OutboxRecorder& on(const M& message, Sclk now = Sclk{1.0}) {
        recorder.begin(id, now);
        module.on(message, recorder.out);
        return recorder;
    }
};

inline flight::UnitsSelected all_b() {
    flight::UnitsSelected selected;
    for (std::size_t i = 0; i < flight::redundant_device_count; ++i)
        selected.units[static_cast<flight::Device>(i)] = flight::Unit::b;
    return selected;
}

/// Whether a manager of the rate group confirms each tick and addresses the unit it was given.
template <typename Module>
bool confirms_and_addresses(flight::ModuleId id, flight::Device device) {
    Spoken<Module> spoken{id};
    spoken.recorder.bus->units[device] = flight::Unit::b;
    const auto confirmed = [&] {
        const auto confirms = spoken.on(flight::Tick{Sclk{1.0}}).template sent<flight::Confirm>();
        return confirms.size() == 1 && confirms[0].from == id;
    };
    if (!confirmed() || spoken.recorder.bus->units[device] != flight::Unit::a) return false;
    spoken.on(all_b());
    return confirmed() && spoken.recorder.bus->units[device] == flight::Unit::b;
}

}  // namespace aeolis::test
