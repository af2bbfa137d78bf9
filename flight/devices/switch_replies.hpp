// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"

#include <array>

namespace aeolis::flight {

/// Switch commands that have not been answered yet; shared by the power and telecom managers.
/// It keeps no time: the timeline decides whether an answer is too late.
class SwitchReplies {
  public:
    /// Puts `command` on its owner's part of the bus, or reports that there is no room (SWITCH_QUEUE_FULL).
    void command(const SetSwitch& command, SwitchCommands& bus, Outbox& out);
    /// Turns a reply into an answer for the timeline, verified or refused. Also reports a reply that refuses,
    /// contradicts the command, was not due, or comes from the other unit.
    void reply(const SwitchReply& reply, Unit selected, Outbox& out);
    /// The state of a switch by its last reply, or by a command that is not answered yet.
    SwitchState state(SwitchId id) const { return awaited_[static_cast<std::size_t>(id)].state; }

  private:
    struct Awaited {
        bool on = false;  // by the last command
        std::uint8_t replies_due = 0;
        SwitchState state{};
    };
    std::array<Awaited, switch_count> awaited_{};
};

}  // namespace aeolis::flight
