#include "flight/devices/device_managers.hpp"

namespace aeolis::flight {
namespace {

constexpr double bridle_tolerance_m = 0.01;  // ours: of the pay-out sensor

void answer(Outbox& out, ReplyKind kind, std::uint8_t id) {
    out.send(ModuleId::edl, ActionReply{kind, id});
}

}  // namespace

void RadarManager::on(const RadarReturns& returns, Outbox&) {
    latest_ = returns;
}

void RadarManager::on(const Tick&, Outbox& out) {
    if (!latest_.beams.empty()) out.send(ModuleId::edl_bg, latest_);
    latest_.beams.clear();
    out.send(ModuleId::sync, Confirm{ModuleId::radar});
}

void ImuManager::on(const ImuReadings& readings, Outbox&) {
    latest_ = readings;
}

void ImuManager::on(const Tick&, Outbox& out) {
    out.send(ModuleId::edl, latest_);
    if (!latest_.samples.empty()) out.send(ModuleId::edl_comm, latest_);
    latest_.samples.clear();
    out.send(ModuleId::sync, Confirm{ModuleId::imu});
}

void PyroManager::on(const FirePyro& command, Outbox& out) {
    if (!due_.try_push_back(command.pyro))
        out.event(evr::PYRO_QUEUE_FULL{.pyro = static_cast<std::uint8_t>(command.pyro)});
}

void PyroManager::on(const PyroReply& reply, Outbox& out) {
    const auto device = static_cast<std::uint8_t>(reply.pyro);
    if (reply.fired)
        answer(out, ReplyKind::pyro, device);
    else
        out.event(evr::PYRO_NOT_FIRED{.pyro = device});
}

void PyroManager::on(const Tick&, Outbox& out) {
    for (const PyroId pyro : due_) out.bus().pyros.push_back(pyro);
    due_.clear();
    out.send(ModuleId::sync, Confirm{ModuleId::pyro});
}

void DescentEngines::on(const RunEngines& command, Outbox&) {
    command_ = command.engines;
}

void DescentEngines::on(const PayOutBridle&, Outbox&) {
    pay_out_ = true;
}

void DescentEngines::on(const EngineReply& reply, Outbox& out) {
    if (reply.running && !running_) answer(out, ReplyKind::engines, 0);
    running_ = reply.running;
    out.send(ModuleId::edl, reply);
}

void DescentEngines::on(const BridleReply& reply, Outbox& out) {
    if (!payed_out_ && reply.payed_out_m >= ParameterDefaults{}.bridle_length_m - bridle_tolerance_m) {
        payed_out_ = true;
        answer(out, ReplyKind::bridle, 0);
    }
    out.send(ModuleId::edl, reply);
}

void DescentEngines::on(const Tick&, Outbox& out) {
    out.bus().engines = command_;
    out.bus().pay_out_bridle = pay_out_;
    out.send(ModuleId::sync, Confirm{ModuleId::descent_engines});
}

void Thrusters::on(const PointVehicle& command, Outbox&) {
    attitude_ = command.attitude;
}

void Thrusters::on(const EnableThrusters& command, Outbox& out) {
    out.bus().thrusters_enabled = command.enabled;
}

void Thrusters::on(const ThrusterReply&, Outbox& out) {
    answer(out, ReplyKind::thrusters, 0);
}

void Thrusters::on(const Tick&, Outbox& out) {
    out.bus().attitude = attitude_;
    out.send(ModuleId::sync, Confirm{ModuleId::thrusters});
}

void PowerManager::on(const SetSwitch& command, Outbox& out) {
    if (!out.bus().switches.try_push_back({command.id, command.on}))
        out.event(evr::SWITCH_QUEUE_FULL{.switch_number = static_cast<std::uint8_t>(command.id)});
}

void PowerManager::on(const SwitchReply& reply, Outbox& out) {
    answer(out, ReplyKind::device_switch, static_cast<std::uint8_t>(reply.id));
}

}  // namespace aeolis::flight
