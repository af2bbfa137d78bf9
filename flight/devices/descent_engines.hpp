// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the descent engines and the bridle's brake, on the 64 Hz bus. R5, R10, R22
/// In the rate group: it confirms every tick, idle or not.
///
/// In      RunEngines, PayOutBridle, EngineReply and BridleReply (interrupts), Tick, UnitsSelected
/// Out     engine commands at its tick; EngineReply and BridleReply forwarded to Edl; ActionReply when the engines
///         start or stop, and when a released bridle begins to pay out; Confirm
/// Faults  what does not react sends no reply: a time-out handles it. Engines that stop by themselves are reported
class DescentEngines {
  public:
    explicit DescentEngines(const Load&) {}

    void on(const RunEngines& command, Outbox& out);
    void on(const PayOutBridle& command, Outbox& out);
    void on(const EngineReply& reply, Outbox& out);
    void on(const BridleReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    EngineCommand command_;
    Unit unit_ = Unit::a;
    bool pay_out_ = false;
    bool running_ = false;
    bool reply_due_ = false;  // of the bridle
};

}  // namespace aeolis::flight
