// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/radar.hpp"

namespace aeolis::flight {

void RadarManager::on(const RadarReturns& returns, Outbox&) {
    latest_ = returns;
}

void RadarManager::on(const UnitsSelected& selected, Outbox&) {
    unit_ = selected.units[Device::radar];
}

void RadarManager::on(const Tick&, Outbox& out) {
    out.bus().units[Device::radar] = unit_;
    if (!latest_.beams.empty())
        for (const ModuleId module : {ModuleId::edl_bg, ModuleId::edl_comm}) out.send(module, latest_);
    latest_.beams.clear();
    out.send(ModuleId::sync, Confirm{ModuleId::radar});
}

}  // namespace aeolis::flight
