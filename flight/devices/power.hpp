// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/switch_replies.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of power switching, on the 8 Hz bus: radar, IMU, thruster heaters.
/// Outside the rate group. R5, R10, R28
///
/// In      SetSwitch, SwitchReply (interrupt), UnitsSelected
/// Out     switch commands; ActionReply to Edl, verified or refused; PowerStatus on change
/// Faults  reports a refusal (DEVICE_REFUSED), a state other than commanded (REPLY_CONTRADICTS), and a reply that was
///         not due or from the other unit (REPLY_UNEXPECTED)
class PowerManager {
  public:
    explicit PowerManager(const Load&) {}

    void on(const SetSwitch& command, Outbox& out);
    void on(const SwitchReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);

  private:
    void record(Outbox& out);

    SwitchReplies replies_;
    packet::PowerStatus recorded_;
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
