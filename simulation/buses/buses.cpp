// SPDX-License-Identifier: Apache-2.0
#include "simulation/buses/buses.hpp"

namespace aeolis::simulation {
namespace {

using flight::Device;
using flight::Unit;
using Kind = DeviceFault::Kind;

constexpr std::int64_t hold_ticks = 128;          // 2 s [facts] Second Chance
constexpr std::size_t replies_of_a_kind_max = 8;  // of DeviceInputs

constexpr bool on_64_hz(Device device) {
    return device == Device::radar || device == Device::pyro || device == Device::descent_engines ||
           device == Device::thrusters;
}

}  // namespace

Buses::Buses(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number)
    : bus_64_hz_(1, scenario.bus_message_error_fraction, Random{seed, case_number, Stream::bus_64_hz}),
      bus_8_hz_(8, scenario.bus_message_error_fraction, Random{seed, case_number, Stream::bus_8_hz}),
      faults_(scenario.device_faults, scenario.entry_sclk),
      devices_(scenario.start_before_entry_s, Random{seed, case_number, Stream::devices}),
      imu_link_(seed, case_number, Stream::imu_link) {}

void Buses::disperse(std::uint64_t seed, std::uint64_t case_number) {
    bus_64_hz_.disperse({seed, case_number, Stream::bus_64_hz});
    bus_8_hz_.disperse({seed, case_number, Stream::bus_8_hz});
    devices_.disperse({seed, case_number, Stream::devices});
    imu_link_ = {seed, case_number, Stream::imu_link};
}

void Buses::place(const PlacedState& state) {
    devices_.place(state);
    engines_ = state.engines;
    pay_out_bridle_ = state.bridle.has_value();
    engines_tick_ = state.sclk.ticks();
}

void Buses::add_to(PlacedState& state) const {
    devices_.add_to(state);
    state.engines = engines_;
}

void Buses::take(const flight::DeviceOutputs& out) {
    commanded_ = true;
    addressed_ = out.units;
    thrusters_due_ = out.thrusters;
    engines_due_ = out.engines;
    pay_out_bridle_due_ = out.pay_out_bridle;
    for (const flight::PyroCommand& command : out.pyros) {
        if (static_cast<std::size_t>(command.id) >= flight::pyro_count) continue;
        bus_64_hz_.queue({.device = Device::pyro,
                          .unit = command.unit,
                          .kind = BusCommand::Kind::pyro,
                          .pyro = command.id,
                          .on = true});
    }
    if (out.thrusters_enabled)
        bus_64_hz_.queue({.device = Device::thrusters,
                          .unit = addressed_[Device::thrusters],
                          .kind = BusCommand::Kind::thrusters,
                          .on = *out.thrusters_enabled});
    take_switches(out.switches);
    take_switches(out.telecom);
}

void Buses::take_switches(const flight::SwitchCommands& commands) {
    for (const flight::SwitchCommand& wanted : commands) {
        using flight::SwitchId;
        if (static_cast<std::size_t>(wanted.id) >= flight::switch_count) continue;
        const Device device = flight::switched_by(wanted.id);
        const flight::Unit switched = wanted.id == SwitchId::radar         ? addressed_[Device::radar]
                                      : wanted.id == SwitchId::descent_imu ? addressed_[Device::imu]
                                                                           : flight::Unit::a;
        bus_8_hz_.queue({.device = device,
                         .unit = addressed_[device],
                         .kind = BusCommand::Kind::device_switch,
                         .switch_id = wanted.id,
                         .switched = switched,
                         .on = wanted.on});
    }
}

void Buses::frame(Sclk now) {
    const std::int64_t tick = now.ticks();
    faults_.at(now);
    fired_.clear();
    fetched_.clear();
    radar_was_read_ = engines_were_read_ = rover_imu_was_read_ = false;
    thrusters_ = {};  // pulses are commanded anew each tick
    if (commanded_) {
        run(bus_64_hz_, tick);
        run_cyclic(tick);
        if (bus_8_hz_.frame_begins(tick)) {
            run(bus_8_hz_, tick);
            rover_imu_was_read_ = bus_8_hz_.exchange() && faults_.answers(Device::rover_imu, Unit::a);
        }
    }
    if (tick - engines_tick_ > hold_ticks) engines_ = {};
}

void Buses::run(Bus& bus, std::int64_t tick) {
    bus.send([&](const BusCommand& command) {
        if (!faults_.answers(command.device, command.unit)) return false;
        if (devices_.execute(command, tick, faults_)) fired_.push_back(command.pyro);
        return true;
    });
    fetch(bus, tick);
}

bool Buses::obeys(Device device) const {
    const flight::Unit unit = addressed_[device];
    return faults_.answers(device, unit) && !faults_.has(Kind::refuses, device, unit);
}

void Buses::run_cyclic(std::int64_t tick) {
    if (bus_64_hz_.exchange() && obeys(Device::thrusters)) {
        thrusters_ = thrusters_due_;
    }
    if (bus_64_hz_.exchange() && obeys(Device::descent_engines)) {
        engines_ = engines_due_;
        pay_out_bridle_ = pay_out_bridle_due_;
        engines_tick_ = tick;
    }
    engines_were_read_ =
        bus_64_hz_.exchange() && faults_.answers(Device::descent_engines, addressed_[Device::descent_engines]);
    const flight::Unit radar = addressed_[Device::radar];
    radar_was_read_ =
        devices_.on(flight::SwitchId::radar, radar) && bus_64_hz_.exchange() && faults_.answers(Device::radar, radar);
}

void Buses::fetch(Bus& bus, std::int64_t tick) {
    auto& replies = devices_.replies();
    for (std::size_t i = 0; i < replies.size();) {
        const Avionics::Reply& reply = replies[i];
        const bool here = on_64_hz(reply.device) == (&bus == &bus_64_hz_);
        if (!here || reply.ready_tick > tick || fetched_.size() == replies_of_a_kind_max) {
            ++i;
            continue;
        }
        // A terminal that has fallen silent loses its pending replies.
        const bool answers = faults_.answers(reply.device, reply.unit);
        if (answers && !bus.exchange()) {
            ++i;
            continue;
        }
        if (answers) fetched_.push_back(reply);
        replies.erase_at(i);
    }
}

void Buses::reply(flight::DeviceInputs& in) const {
    for (const Avionics::Reply& reply : fetched_) {
        switch (reply.kind) {
        case BusCommand::Kind::pyro: in.pyro_replies.push_back({reply.pyro, reply.on, reply.unit}); break;
        case BusCommand::Kind::device_switch:
            in.switch_replies.push_back({reply.switch_id, reply.on, reply.unit, reply.refused});
            break;
        case BusCommand::Kind::thrusters:
            in.thrusters = flight::ThrusterReply{reply.on, reply.unit, reply.refused};
            break;
        }
    }
}

bool Buses::uhf_radiates() const {
    using flight::SwitchId;
    const flight::Unit uhf = addressed_[Device::uhf];
    return devices_.on(SwitchId::uhf) &&
           (devices_.on(SwitchId::entry_antenna) || devices_.on(SwitchId::parachute_antenna)) &&
           !faults_.has(Kind::dropout, Device::uhf, uhf);
}

std::optional<XBandAntenna> Buses::x_band_antenna() const {
    if (devices_.on(flight::SwitchId::parachute_antenna)) return XBandAntenna::parachute;
    if (devices_.on(flight::SwitchId::entry_antenna)) return XBandAntenna::entry;
    return {};
}

bool Buses::imu_sample_arrives() {
    const flight::Unit imu = addressed_[Device::imu];
    if (!devices_.on(flight::SwitchId::descent_imu, imu) || !faults_.answers(Device::imu, imu)) return false;
    return !faults_.has(Kind::dropout, Device::imu, imu) || imu_link_.uniform() < 0.5;
}

}  // namespace aeolis::simulation
