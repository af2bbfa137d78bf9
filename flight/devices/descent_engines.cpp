// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/descent_engines.hpp"

namespace aeolis::flight {

void DescentEngines::on(const RunEngines& command, Outbox&) {
    command_ = command.engines;
}

void DescentEngines::on(const PayOutBridle&, Outbox&) {
    pay_out_ = reply_due_ = true;
}

void DescentEngines::on(const EngineReply& reply, Outbox& out) {
    if (reply.running != running_) {
        out.send(ModuleId::edl, ActionReply{ReplyKind::engines, static_cast<std::uint8_t>(reply.running)});
        if (!reply.running && command_.ignited)
            out.event(evr::REPLY_CONTRADICTS{.device = static_cast<DeviceName>(Device::descent_engines)});
    }
    running_ = reply.running;
    out.send(ModuleId::edl, reply);
}

void DescentEngines::on(const BridleReply& reply, Outbox& out) {
    if (reply_due_ && reply.payed_out_m >= build_parameters.bridle_runs_m) {
        reply_due_ = false;
        out.send(ModuleId::edl, ActionReply{ReplyKind::bridle, 0});
    }
    out.send(ModuleId::edl, reply);
}

void DescentEngines::on(const UnitsSelected& selected, Outbox&) {
    unit_ = selected.units[Device::descent_engines];
}

void DescentEngines::on(const Tick&, Outbox& out) {
    out.bus().units[Device::descent_engines] = unit_;
    out.bus().engines = command_;
    out.bus().pay_out_bridle = pay_out_;
    out.send(ModuleId::sync, Confirm{ModuleId::descent_engines});
}

}  // namespace aeolis::flight
