// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/power.hpp"

namespace aeolis::flight {

void PowerManager::on(const SetSwitch& command, Outbox& out) {
    out.bus().units[Device::power] = unit_;
    replies_.command(command, out.bus().switches, out);
    record(out);
}

void PowerManager::on(const SwitchReply& reply, Outbox& out) {
    replies_.reply(reply, unit_, out);
    record(out);
}

void PowerManager::record(Outbox& out) {
    const packet::PowerStatus status{.switch_radar = replies_.state(SwitchId::radar),
                                     .switch_descent_imu = replies_.state(SwitchId::descent_imu),
                                     .switch_thruster_heaters = replies_.state(SwitchId::thruster_heaters)};
    if (status != recorded_) out.record(status);
    recorded_ = status;
}

void PowerManager::on(const UnitsSelected& selected, Outbox& out) {
    unit_ = selected.units[Device::power];
    out.bus().units[Device::power] = unit_;
}

}  // namespace aeolis::flight
