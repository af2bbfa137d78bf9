// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the thruster drivers, on the 64 Hz bus.
/// In the rate group: it confirms every tick, idle or not. R5, R10, R22
///
/// In      FireThrusters, EnableThrusters, ThrusterReply (interrupt), Tick, UnitsSelected
/// Out     on-times and enable commands, at its tick, once; ActionReply to Edl when the driver is as commanded; Confirm
/// Faults  a refusal is reported (DEVICE_REFUSED) and no ActionReply is sent: the timeline's time-out handles it. A
///         reply that was not due, or from the other unit, is reported (REPLY_UNEXPECTED)
class Thrusters {
  public:
    explicit Thrusters(const Load&) {}

    void on(const FireThrusters& command, Outbox& out);
    void on(const EnableThrusters& command, Outbox& out);
    void on(const ThrusterReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    ThrusterCommand thrusters_;    // for the next tick only
    std::optional<bool> enable_;   // to be commanded at the next tick
    std::optional<bool> awaited_;  // the state that the pending reply should report
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
