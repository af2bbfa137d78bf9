// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/sync.hpp"

namespace aeolis::flight {

void Sync::on(const ClockTick& tick, Outbox& out) {
    if (mailbox_overflows_ != overflows_told_) {
        overflows_told_ = mailbox_overflows_;
        out.event(evr::MAILBOX_OVERFLOW{.lost = mailbox_overflows_});
    }
    if (at_resolution(tick.now, 1) == tick.now)
        out.record(packet::SyncStatus{.cycles = static_cast<std::uint32_t>(cycles_),
                                      .overruns = static_cast<std::uint32_t>(overruns_),
                                      .mailbox_overflows = mailbox_overflows_,
                                      .unexpected_messages = unexpected_messages_});
    if (running_ != idle) {
        ++overruns_;
        out.event(evr::CYCLE_OVERRUN{.overruns = static_cast<std::uint32_t>(overruns_)});
        out.send(ModuleId::mfsk, ToneRequest{tone::overrun, tick.now});
        return;
    }
    now_ = tick.now;
    running_ = 0;
    out.send(order[0], Tick{now_});
}

void Sync::on(const Confirm& confirm, Outbox& out) {
    if (running_ == idle || confirm.from != order[running_]) return;  // not the confirmation awaited
    if (++running_ == idle)
        ++cycles_;
    else
        out.send(order[running_], Tick{now_});
}

}  // namespace aeolis::flight
