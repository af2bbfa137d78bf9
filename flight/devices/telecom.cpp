// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/telecom.hpp"

namespace aeolis::flight {

void TelecomManager::on(const SetSwitch& command, Outbox& out) {
    address(out);
    replies_.command(command, out.bus().telecom, out);
    record(out);
}

void TelecomManager::on(const SwitchReply& reply, Outbox& out) {
    replies_.reply(reply, units_[switched_by(reply.id)], out);
    record(out);
}

void TelecomManager::record(Outbox& out) {
    const packet::TelecomStatus status{.switch_uhf = replies_.state(SwitchId::uhf),
                                       .switch_entry_antenna = replies_.state(SwitchId::entry_antenna),
                                       .switch_parachute_antenna = replies_.state(SwitchId::parachute_antenna),
                                       .switch_x_band_tones = replies_.state(SwitchId::x_band_tones)};
    if (status != recorded_) out.record(status);
    recorded_ = status;
}

void TelecomManager::on(const UnitsSelected& selected, Outbox& out) {
    units_ = selected.units;
    address(out);
}

void TelecomManager::address(Outbox& out) const {
    out.bus().units[Device::uhf] = units_[Device::uhf];
    out.bus().units[Device::x_band] = units_[Device::x_band];
}

}  // namespace aeolis::flight
