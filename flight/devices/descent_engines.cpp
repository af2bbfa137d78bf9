// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/descent_engines.hpp"

namespace aeolis::flight {
namespace {

constexpr double bridle_tolerance_m = 0.01;  // chosen: tolerance of the pay-out sensor

}  // namespace

void DescentEngines::on(const RunEngines& command, Outbox&) {
    command_ = command.engines;
}

void DescentEngines::on(const PayOutBridle&, Outbox&) {
    pay_out_ = true;
}

void DescentEngines::on(const EngineReply& reply, Outbox& out) {
    if (reply.running && !running_) out.send(ModuleId::edl, ActionReply{ReplyKind::engines, 0});
    running_ = reply.running;
    out.send(ModuleId::edl, reply);
}

void DescentEngines::on(const BridleReply& reply, Outbox& out) {
    if (!payed_out_ && reply.payed_out_m >= parameters.bridle_length_m - bridle_tolerance_m) {
        payed_out_ = true;
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
