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
    ++replies_due_;
    enable_ = awaited_ = command.enabled;
}

void Thrusters::on(const ThrusterReply& reply, Outbox& out) {
    if (replies_due_ == 0 || reply.unit != unit_)
        return out.event(evr::REPLY_UNEXPECTED{.device_number = thrusters_device});
    const bool as_commanded = !reply.refused && reply.enabled == awaited_;
    if (reply.refused)
        out.event(evr::DEVICE_REFUSED{.device_number = thrusters_device});
    else if (!as_commanded && replies_due_ == 1)
        out.event(evr::REPLY_CONTRADICTS{.device_number = thrusters_device});
    --replies_due_;
    // This reply answers an older command; the reply to the newer one is still due.
    if (!as_commanded && replies_due_ > 0) return;
    replies_due_ = 0;
    out.send(ModuleId::edl,
             ActionReply{ReplyKind::thrusters, 0, as_commanded ? Evidence::verified : Evidence::refused, awaited_});
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
