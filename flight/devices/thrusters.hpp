// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the thruster drivers, on the 64 Hz bus.
/// In the rate group: it confirms every tick, idle or not. R5, R10, R22
///
/// In      FireThrusters, EnableThrusters, ThrusterReply (interrupt), Tick, UnitsSelected
/// Out     on-times and enable commands, at its tick, once; ActionReply to Edl, verified or refused; ThrusterPulses in
///         each cycle with a pulse, and on change; Confirm
/// Faults  reports a refusal (DEVICE_REFUSED), a state other than commanded (REPLY_CONTRADICTS), and a reply that was
///         not due or from the other unit (REPLY_UNEXPECTED)
class Thrusters {
  public:
    explicit Thrusters(const Load&) {}

    void on(const FireThrusters& command, Outbox& out);
    void on(const EnableThrusters& command, Outbox& out);
    void on(const ThrusterReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    void record(const ThrusterCommand& pulses, Outbox& out);

    ThrusterCommand thrusters_;  // of the next tick, then none
    packet::ThrusterPulses recorded_;
    std::optional<bool> enable_;  // to be commanded at the next tick
    bool awaited_ = false;        // what the reply to the last command should say
    bool enabled_ = false;        // by the last reply
    std::uint8_t replies_due_ = 0;
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
