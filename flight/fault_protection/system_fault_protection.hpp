// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Asks EDL to make no progress while the spacecraft has a fault that must be put right first, so that neither
/// disturbs the other. Whether EDL may still be inhibited is EDL's own rule: before the end of pre-EDL only. R24
///
/// In      SystemFaultReport, each second while there is a fault, and once when it is over
/// Out     InhibitEdl with each report, so that one that was lost is made good by the next
/// Faults  the repair itself is the spacecraft's, not modelled here
class SystemFaultProtection {
  public:
    explicit SystemFaultProtection(const Load&) {}

    void on(const SystemFaultReport& report, Outbox& out);
};

}  // namespace aeolis::flight
