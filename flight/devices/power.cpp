// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/power.hpp"

namespace aeolis::flight {

void PowerManager::on(const SetSwitch& command, Outbox& out) {
    out.bus().units[Device::power] = unit_;
    replies_.command(command, out.bus().switches, out);
}

void PowerManager::on(const SwitchReply& reply, Outbox& out) {
    replies_.reply(reply, unit_, out);
}

void PowerManager::on(const UnitsSelected& selected, Outbox& out) {
    unit_ = selected.units[Device::power];
    out.bus().units[Device::power] = unit_;
}

}  // namespace aeolis::flight
