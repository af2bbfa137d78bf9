// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Asks EDL to hold while the spacecraft has a fault that must be repaired first.
/// The repair and EDL must not disturb each other. Edl itself decides whether it may still be inhibited: only until the
/// end of pre-EDL. R24
///
/// In      SystemFaultReport, each second during a fault, and once when it is over
/// Out     InhibitEdl with each report, so that the next one makes up for a lost one
/// Faults  the repair itself is up to the spacecraft and not modelled here
class SystemFaultProtection {
  public:
    explicit SystemFaultProtection(const Load&) {}

    void on(const SystemFaultReport& report, Outbox& out);
};

}  // namespace aeolis::flight
