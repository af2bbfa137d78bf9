// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/switch_replies.hpp"

namespace aeolis::flight {

void SwitchReplies::command(const SetSwitch& command, SwitchCommands& bus, Outbox& out) {
    const auto number = static_cast<std::size_t>(command.id);
    if (number >= switch_count || !bus.try_push_back({command.id, command.on}))
        return out.event(evr::SWITCH_QUEUE_FULL{.switch_number = static_cast<std::uint8_t>(command.id)});
    awaited_[number] = command.on;
}

void SwitchReplies::reply(const SwitchReply& reply, Unit selected, Outbox& out) {
    const auto device = static_cast<std::uint8_t>(switched_by(reply.id));
    const auto number = static_cast<std::size_t>(reply.id);
    if (number >= switch_count || !awaited_[number] || reply.unit != selected)
        return out.event(evr::REPLY_UNEXPECTED{.device_number = device});
    // This reply answers an older command; the reply to the newer one is still due.
    if (!reply.refused && reply.on != *awaited_[number]) return;
    awaited_[number].reset();
    if (reply.refused) return out.event(evr::DEVICE_REFUSED{.device_number = device});
    out.send(ModuleId::edl, ActionReply{ReplyKind::device_switch, static_cast<std::uint8_t>(reply.id)});
}

}  // namespace aeolis::flight
