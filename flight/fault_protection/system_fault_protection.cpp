// SPDX-License-Identifier: Apache-2.0
#include "flight/fault_protection/system_fault_protection.hpp"

namespace aeolis::flight {

void SystemFaultProtection::on(const SystemFaultReport& report, Outbox& out) {
    out.send(ModuleId::edl, InhibitEdl{report.present});
}

}  // namespace aeolis::flight
