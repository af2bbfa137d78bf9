// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/pyro.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::flight {
namespace {

constexpr std::array both_controllers{Unit::a, Unit::b};

void answer(PyroId pyro, Evidence evidence, Outbox& out) {
    out.send(ModuleId::edl, ActionReply{ReplyKind::pyro, static_cast<std::uint8_t>(pyro), evidence});
}

RedundantUnit reported(Unit unit) {
    return static_cast<RedundantUnit>(unit);
}
PyroName reported(PyroId pyro) {
    return static_cast<PyroName>(pyro);
}
// The dictionary numbers pyros as the devices do.
static_assert(static_cast<PyroId>(PyroName::cruise_cable_cutter) == PyroId::cruise_cable_cutter);
static_assert(static_cast<PyroId>(PyroName::parachute_mortar) == PyroId::parachute_mortar);
static_assert(static_cast<PyroId>(PyroName::thermal_batteries) == PyroId::thermal_batteries &&
              pyro_count == static_cast<std::size_t>(PyroName::thermal_batteries) + 1);

}  // namespace

void PyroManager::on(const ArmPyros& command, Outbox& out) {
    armed_ = command.armed;
    out.send(ModuleId::edl, ActionReply{ReplyKind::arming, static_cast<std::uint8_t>(armed_)});
}

void PyroManager::on(const FirePyro& command, Outbox& out) {
    const auto number = static_cast<std::size_t>(command.pyro);
    if (number >= pyro_count)
        return out.event(evr::PYRO_UNKNOWN{.pyro_number = static_cast<std::uint8_t>(command.pyro)});
    if (!armed_) {
        out.event(evr::PYRO_NOT_ARMED{.pyro = reported(command.pyro)});
        return answer(command.pyro, Evidence::refused, out);
    }
    Shot& shot = shots_[number];
    shot.wanted = true;
    shot.fired = false;
    shot.until = command.until;
    shot.next_try = {};
    for (Controller& controller : shot.controllers) controller.refuses = controller.refusal_told = false;
}

void PyroManager::on(const PyroReply& reply, Outbox& out) {
    const auto number = static_cast<std::size_t>(reply.pyro);
    const auto place = static_cast<std::size_t>(reply.unit);
    if (number >= pyro_count || place >= both_controllers.size() || shots_[number].controllers[place].replies_due == 0)
        return out.event(evr::REPLY_UNEXPECTED{.device = static_cast<DeviceName>(Device::pyro)});
    Shot& shot = shots_[number];
    Controller& controller = shot.controllers[place];
    --controller.replies_due;
    controller.refuses = !reply.fired;
    if (reply.fired) {
        if (!shot.fired) answer(reply.pyro, Evidence::verified, out);
        shot.fired = true;
        return;
    }
    if (!controller.refusal_told)
        out.event(evr::PYRO_CONTROLLER_REFUSED{.pyro = reported(reply.pyro), .controller = reported(reply.unit)});
    controller.refusal_told = true;
    if (!shot.fired && std::ranges::all_of(shot.controllers, &Controller::refuses))
        answer(reply.pyro, Evidence::refused, out);
}

void PyroManager::on(const UnitsSelected& selected, Outbox&) {
    const Unit unit = selected.units[Device::pyro];
    if (std::ranges::find(both_controllers, unit) != both_controllers.end()) unit_ = unit;
}

void PyroManager::on(const Tick& tick, Outbox& out) {
    out.bus().units[Device::pyro] = unit_;
    for (std::size_t i = 0; i < pyro_count; ++i) {
        Shot& shot = shots_[i];
        if (!shot.wanted) continue;
        const auto pyro = static_cast<PyroId>(i);
        const bool first = !shot.next_try.defined();
        if (armed_ && !shot.fired && (first || (tick.now >= shot.next_try && tick.now + retry_s <= shot.until)))
            fire(pyro, shot, out);
        else if (tick.now >= shot.until)
            end(pyro, shot, out);
    }
    record(tick.now, out);
    out.send(ModuleId::sync, Confirm{ModuleId::pyro});
}

PyroState PyroManager::state(PyroId pyro) const {
    AEOLIS_CHECK(static_cast<std::size_t>(pyro) < pyro_count);
    const Shot& shot = shots_[static_cast<std::size_t>(pyro)];
    if (shot.fired) return PyroState::fired;
    if (shot.wanted) return PyroState::commanded;
    if (!shot.next_try.defined()) return PyroState::not_commanded;
    return std::ranges::all_of(shot.controllers, &Controller::refuses) ? PyroState::refused : PyroState::unanswered;
}

void PyroManager::record(Sclk now, Outbox& out) {
    const packet::PyroStatus status{.pyro_cruise_cable_cutter = state(PyroId::cruise_cable_cutter),
                                    .pyro_cruise_stage_separation = state(PyroId::cruise_stage_separation),
                                    .pyro_cruise_balance_1 = state(PyroId::cruise_balance_1),
                                    .pyro_cruise_balance_2 = state(PyroId::cruise_balance_2),
                                    .pyro_entry_balance_1 = state(PyroId::entry_balance_1),
                                    .pyro_entry_balance_2 = state(PyroId::entry_balance_2),
                                    .pyro_entry_balance_3 = state(PyroId::entry_balance_3),
                                    .pyro_parachute_mortar = state(PyroId::parachute_mortar),
                                    .pyro_heatshield_separation = state(PyroId::heatshield_separation),
                                    .pyro_engine_valves = state(PyroId::engine_valves),
                                    .pyro_backshell_separation = state(PyroId::backshell_separation),
                                    .pyro_rover_separation = state(PyroId::rover_separation),
                                    .pyro_bridle_cutter = state(PyroId::bridle_cutter),
                                    .pyro_coolant_vent = state(PyroId::coolant_vent),
                                    .pyro_pressurant_valve_1 = state(PyroId::pressurant_valve_1),
                                    .pyro_pressurant_valve_2 = state(PyroId::pressurant_valve_2),
                                    .pyro_thermal_batteries = state(PyroId::thermal_batteries),
                                    .pyro_manager_armed = armed_};
    if (status != recorded_ || (armed_ && at_resolution(now, 1) == now)) out.record(status);
    recorded_ = status;
}

// A pyro without room on the bus waits for the next cycle.
void PyroManager::fire(PyroId pyro, Shot& shot, Outbox& out) {
    AEOLIS_CHECK(armed_ && shot.wanted && !shot.fired);
    auto& bus = out.bus().pyros;
    if (bus.size() + both_controllers.size() > bus.capacity()) return;
    if (shot.next_try.defined()) answer(pyro, Evidence::none, out);
    for (const Unit unit : {unit_, unit_ == Unit::a ? Unit::b : Unit::a}) {
        Controller& controller = shot.controllers[static_cast<std::size_t>(unit)];
        bus.push_back({pyro, unit});
        ++controller.replies_due;
        controller.refuses = false;
    }
    shot.next_try = out.now() + retry_s;
}

void PyroManager::end(PyroId pyro, Shot& shot, Outbox& out) {
    AEOLIS_CHECK(shot.wanted);
    shot.wanted = false;
    for (const Unit unit : both_controllers) {
        const Controller& controller = shot.controllers[static_cast<std::size_t>(unit)];
        if (controller.replies_due != 0 && !controller.refusal_told)
            out.event(evr::PYRO_CONTROLLER_SILENT{.pyro = reported(pyro), .controller = reported(unit)});
    }
    if (!shot.fired && std::ranges::all_of(shot.controllers, &Controller::refuses))
        out.event(evr::PYRO_REFUSED{.pyro = reported(pyro)});
}

}  // namespace aeolis::flight
