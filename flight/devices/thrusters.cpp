// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/thrusters.hpp"

#include <utility>

namespace aeolis::flight {
namespace {

constexpr auto thrusters_device = static_cast<std::uint8_t>(Device::thrusters);

}  // namespace

void Thrusters::on(const FireThrusters& command, Outbox&) {
    thrusters_ = command.thrusters;
}

void Thrusters::on(const EnableThrusters& command, Outbox&) {
    enable_ = awaited_ = command.enabled;
}

void Thrusters::on(const ThrusterReply& reply, Outbox& out) {
    if (!awaited_ || reply.unit != unit_) return out.event(evr::REPLY_UNEXPECTED{.device_number = thrusters_device});
    // This reply answers an older command; the reply to the newer one is still due.
    if (!reply.refused && reply.enabled != *awaited_) return;
    awaited_.reset();
    if (reply.refused) return out.event(evr::DEVICE_REFUSED{.device_number = thrusters_device});
    out.send(ModuleId::edl, ActionReply{ReplyKind::thrusters, 0});
}

void Thrusters::on(const UnitsSelected& selected, Outbox&) {
    unit_ = selected.units[Device::thrusters];
}

void Thrusters::on(const Tick&, Outbox& out) {
    out.bus().units[Device::thrusters] = unit_;
    out.bus().thrusters = std::exchange(thrusters_, {});
    if (enable_) out.bus().thrusters_enabled = enable_;
    enable_.reset();
    out.send(ModuleId::sync, Confirm{ModuleId::thrusters});
}

}  // namespace aeolis::flight
