// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"

namespace aeolis::flight {

/// Switch commands that have not been answered yet; shared by the power and telecom managers.
/// It keeps no time: the timeline decides whether an answer is too late.
class SwitchReplies {
  public:
    /// Puts `command` on its owner's part of the bus, or reports that there is no room (SWITCH_QUEUE_FULL).
    void command(const SetSwitch& command, SwitchCommands& bus, Outbox& out);
    /// Turns a reply into an answer for the timeline, or reports it: refused, not due, or from the other unit.
    void reply(const SwitchReply& reply, Unit selected, Outbox& out);

  private:
    std::array<std::optional<bool>, switch_count> awaited_{};
};

}  // namespace aeolis::flight
