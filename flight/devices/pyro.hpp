// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the pyro controllers, on the 64 Hz bus.
/// In the rate group: it confirms every tick, idle or not. R5, R10, R22
///
/// In      FirePyro, PyroReply (interrupt), Tick, UnitsSelected
/// Out     pyros to fire, at its tick; ActionReply to Edl once the controller reports that the pyro fired; Confirm
/// Faults  if the controller did not fire a pyro (PYRO_NOT_FIRED), no ActionReply is sent: the timeline's time-out
///         handles it. A reply that was not due, or from the other unit, is reported (REPLY_UNEXPECTED) and not
///         forwarded
class PyroManager {
  public:
    explicit PyroManager(const Load&) {}

    void on(const FirePyro& command, Outbox& out);
    void on(const PyroReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    FixedVector<PyroId, 8> due_;
    std::array<bool, pyro_count> reply_due_{};
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
