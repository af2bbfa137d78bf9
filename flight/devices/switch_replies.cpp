// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/switch_replies.hpp"

namespace aeolis::flight {

// The dictionary numbers devices as they are numbered here.
static_assert(static_cast<Device>(DeviceName::radar) == Device::radar);
static_assert(static_cast<Device>(DeviceName::x_band) == Device::x_band &&
              redundant_device_count == static_cast<std::size_t>(DeviceName::x_band) + 1);

void SwitchReplies::command(const SetSwitch& command, SwitchCommands& bus, Outbox& out) {
    const auto number = static_cast<std::size_t>(command.id);
    if (number >= switch_count || !bus.try_push_back({command.id, command.on}))
        return out.event(evr::SWITCH_QUEUE_FULL{.switch_number = static_cast<std::uint8_t>(command.id)});
    Awaited& awaited = awaited_[number];
    awaited = {command.on, static_cast<std::uint8_t>(awaited.replies_due + 1),
               command.on ? SwitchState::commanded_on : SwitchState::commanded_off};
}

void SwitchReplies::reply(const SwitchReply& reply, Unit selected, Outbox& out) {
    const auto device = static_cast<DeviceName>(switched_by(reply.id));
    const auto number = static_cast<std::size_t>(reply.id);
    if (number >= switch_count || awaited_[number].replies_due == 0 || reply.unit != selected)
        return out.event(evr::REPLY_UNEXPECTED{.device = device});
    Awaited& awaited = awaited_[number];
    const bool as_commanded = !reply.refused && reply.on == awaited.on;
    if (reply.refused)
        out.event(evr::DEVICE_REFUSED{.device = device});
    else if (!as_commanded && awaited.replies_due == 1)
        out.event(evr::REPLY_CONTRADICTS{.device = device});
    --awaited.replies_due;
    // This reply answers an older command; the reply to the newer one is still due.
    if (!as_commanded && awaited.replies_due > 0) return;
    awaited.replies_due = 0;
    awaited.state = reply.refused ? SwitchState::refused : reply.on ? SwitchState::on : SwitchState::off;
    out.send(ModuleId::edl, ActionReply{ReplyKind::device_switch, static_cast<std::uint8_t>(reply.id),
                                        as_commanded ? Evidence::verified : Evidence::refused, awaited.on});
}

}  // namespace aeolis::flight
