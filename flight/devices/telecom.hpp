// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/switch_replies.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of telecom settings, on the 8 Hz bus: UHF transmitter, X-band's mode, and antenna of UHF and X-band.
/// The X-band unit selects the antenna. Separate from power: power decides whether a box has current, telecom what the
/// radio does with it. Outside the rate group. R5, R10, R28
///
/// In      SetSwitch, SwitchReply (interrupt), UnitsSelected
/// Out     switch commands; ActionReply to Edl, verified or refused; TelecomStatus on change
/// Faults  as for power: DEVICE_REFUSED, REPLY_CONTRADICTS, REPLY_UNEXPECTED
class TelecomManager {
  public:
    explicit TelecomManager(const Load&) {}

    void on(const SetSwitch& command, Outbox& out);
    void on(const SwitchReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);

  private:
    void address(Outbox& out) const;
    void record(Outbox& out);

    SwitchReplies replies_;
    packet::TelecomStatus recorded_;
    UnitSelection units_;
};

}  // namespace aeolis::flight
