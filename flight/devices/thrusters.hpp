// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// The thruster drivers, on the 64 Hz bus. In the rate group: it confirms every tick, idle or not. R5, R10, R22
///
/// In      FireThrusters, EnableThrusters, ThrusterReply (interrupt), Tick, UnitsSelected
/// Out     on-times and enable commands, at its tick, once; ActionReply to Edl when the driver is as commanded; Confirm
/// Faults  a driver that refuses is reported (DEVICE_REFUSED) and answers nobody: the timeline's time-out does. A reply
///         that was not due, or from the other unit, is reported (REPLY_UNEXPECTED)
class Thrusters {
  public:
    explicit Thrusters(const Load&) {}

    void on(const FireThrusters& command, Outbox& out);
    void on(const EnableThrusters& command, Outbox& out);
    void on(const ThrusterReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    ThrusterCommand thrusters_;    // of the next tick, then none
    std::optional<bool> enable_;   // to be commanded at the next tick
    std::optional<bool> awaited_;  // what the reply that is due should say
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
