// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/avionics.hpp"

namespace aeolis::simulation {
namespace {

using flight::SwitchId;

constexpr std::int64_t jitter_ticks = 3;  // 0 … 2
constexpr std::int64_t pyro_ticks = 2;
constexpr std::int64_t thruster_ticks = 3;

constexpr std::int64_t switch_ticks(SwitchId id) {
    switch (id) {
    case SwitchId::radar: return 12;
    case SwitchId::uhf: return 32;
    case SwitchId::descent_imu: return 8;
    case SwitchId::entry_antenna:
    case SwitchId::parachute_antenna:
    case SwitchId::x_band_tones: return 6;
    case SwitchId::thruster_heaters: return 4;
    }
    return 1;
}

std::int64_t work_ticks(const BusCommand& command) {
    switch (command.kind) {
    case BusCommand::Kind::pyro: return pyro_ticks;
    case BusCommand::Kind::thrusters: return thruster_ticks;
    case BusCommand::Kind::device_switch: return switch_ticks(command.switch_id);
    }
    return 1;
}

}  // namespace

Avionics::Avionics(double start_before_entry_s, Random random) : random_(random) {
    const auto start_on = [&](SwitchId id) { on_[static_cast<std::size_t>(id)] = {true, true}; };
    start_on(SwitchId::descent_imu);
    start_on(SwitchId::entry_antenna);
    if (start_before_entry_s < uhf_start_before_entry_s) start_on(SwitchId::uhf);
    if (start_before_entry_s < x_band_tones_before_entry_s) start_on(SwitchId::x_band_tones);
}

void Avionics::place(const PlacedState& state) {
    on_ = state.switched_on;
    fired_ = state.fired;
    thrusters_enabled_ = state.thrusters_enabled;
}

void Avionics::add_to(PlacedState& state) const {
    state.switched_on = on_;
    state.fired = fired_;
    state.thrusters_enabled = thrusters_enabled_;
}

bool Avionics::execute(const BusCommand& command, std::int64_t tick, const DeviceFaults& faults) {
    bool first_firing = false;
    const auto has = [&](DeviceFault::Kind kind) { return faults.has(kind, command.device, command.unit); };
    Reply reply = has(DeviceFault::Kind::refuses)  ? refuse(command)
                  : has(DeviceFault::Kind::claims) ? done(command)
                                                   : obey(command, first_firing);
    if (has(DeviceFault::Kind::denies)) reply = deny(command);
    reply.ready_tick = tick + work_ticks(command) + static_cast<std::int64_t>(random_.bits() % jitter_ticks) +
                       faults.late_ticks(command.device, command.unit);
    // A flooded terminal loses replies; flight's time-outs cover that.
    (void)replies_.try_push_back(reply);
    if (has(DeviceFault::Kind::doubled)) {
        ++reply.ready_tick;
        (void)replies_.try_push_back(reply);
    }
    return first_firing;
}

Avionics::Reply Avionics::obey(const BusCommand& command, bool& first_firing) {
    switch (command.kind) {
    case BusCommand::Kind::pyro: {
        // A repeated firing is answered as fired.
        bool& fired = fired_[static_cast<std::size_t>(command.pyro)];
        first_firing = !fired;
        fired = true;
        break;
    }
    case BusCommand::Kind::device_switch:
        on_[static_cast<std::size_t>(command.switch_id)][static_cast<std::size_t>(command.switched)] = command.on;
        if (command.on && command.switch_id == SwitchId::entry_antenna)
            on_[static_cast<std::size_t>(SwitchId::parachute_antenna)] = {};
        if (command.on && command.switch_id == SwitchId::parachute_antenna)
            on_[static_cast<std::size_t>(SwitchId::entry_antenna)] = {};
        break;
    case BusCommand::Kind::thrusters: thrusters_enabled_ = command.on; break;
    }
    return done(command);
}

Avionics::Reply Avionics::done(const BusCommand& command) {
    return {0, command.device, command.unit, command.kind, command.pyro, command.switch_id, command.on, false};
}

/// As a device replies that has not acted.
Avionics::Reply Avionics::deny(const BusCommand& command) {
    Reply reply = done(command);
    reply.on = !command.on;
    reply.refused = true;
    return reply;
}

Avionics::Reply Avionics::refuse(const BusCommand& command) const {
    const bool as_it_is = command.kind == BusCommand::Kind::pyro        ? false
                          : command.kind == BusCommand::Kind::thrusters ? thrusters_enabled_
                                                                        : on(command.switch_id, command.switched);
    return {0, command.device, command.unit, command.kind, command.pyro, command.switch_id, as_it_is, true};
}

}  // namespace aeolis::simulation
