// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"

namespace aeolis::flight {

/// Which switches have been told something and not answered yet: what power and telecom have in common, and all that
/// either knows of time. Whether an answer comes too late is the timeline's question.
class SwitchReplies {
  public:
    /// Puts `command` on its owner's part of the bus, or reports that there is no room (SWITCH_QUEUE_FULL).
    void command(const SetSwitch& command, SwitchCommands& bus, Outbox& out);
    /// Turns a reply into an answer for the timeline, or into a report: refused, or not due, or from another unit.
    void reply(const SwitchReply& reply, Unit selected, Outbox& out);

  private:
    std::array<std::optional<bool>, switch_count> awaited_{};
};

}  // namespace aeolis::flight
