// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/computers.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

flight::Load load_of(flight::Load load, flight::String string) {
    load.string = string;
    load.role = string == flight::String::a ? flight::Role::prime : flight::Role::second_chance;
    return load;
}

}  // namespace

Computers::Computers(const flight::Load& load, Sclk start)
    : computers_{flight::Computer{load_of(load, flight::String::a), start},
                 flight::Computer{load_of(load, flight::String::b), start}} {}

void Computers::step(flight::DeviceInputs& in) {
    step(in, true);
}

void Computers::step_without_prime(flight::DeviceInputs& in) {
    step(in, false);
}

void Computers::step(flight::DeviceInputs& in, bool with_prime) {
    const std::size_t listening = commander_ == nobody ? prime() : commander_;
    const std::size_t other = 1 - listening;

    beside_.now = in.now;
    beside_.imu = in.imu;
    beside_.uplink.clear();
    for (const flight::UplinkPacket& packet : in.uplink) beside_.uplink.push_back(packet);
    beside_.nvm_used_octets = in.nvm_used_octets;
    beside_.nvm_capacity_octets = in.nvm_capacity_octets;

    const auto complete = [&](std::size_t place, flight::DeviceInputs& inputs) {
        inputs.prime_is_b = prime_is_b_;
        inputs.other_runs_buses = commander_ == 1 - place;
        inputs.cross_string.clear();
        inputs.cross_string.append(out_[1 - place].cross_string.span());
        inputs.restart_record.clear();
        if (out_[place].wants_restart_record) inputs.restart_record.append(restart_record_.span());
    };
    complete(listening, in);
    complete(other, beside_);
    const auto cycle = [&](std::size_t place, const flight::DeviceInputs& inputs) {
        if (place != prime())
            computers_[place].step(inputs, out_[place]);
        else if (with_prime)
            computers_[place].step(inputs, out_[place], runner_.get());
        else
            out_[place].begin_cycle();
    };
    cycle(listening, in);
    if (!backup_off_) cycle(other, beside_);

    for (const flight::DeviceOutputs& out : out_)
        if (!out.restart_record.empty()) restart_record_ = out.restart_record;
    choose_commander();
    if (commander_ != nobody && out_[commander_].designate_b_prime) prime_is_b_ = *out_[commander_].designate_b_prime;
}

const flight::gnc::Configuration& Computers::gnc_configuration() {
    return computers_[commander_ == nobody ? prime() : commander_].gnc_configuration();
}

void Computers::replace_gnc(const flight::gnc::Output& told) {
    for (flight::Computer& computer : computers_) computer.replace_gnc(told);
}

void Computers::shift_navigation(const flight::NavigationShift& by) {
    for (flight::Computer& computer : computers_) computer.shift_navigation(by);
}

void Computers::leave_idle_backup() {
    const std::size_t backup = 1 - prime();
    if (backup_off_ || commander_ != prime() || computers_[backup].may_take_over()) return;
    backup_off_ = true;
    computers_[prime()].tell_no_state();
    out_[backup].begin_cycle();
}

void Computers::choose_commander() {
    const std::size_t backup = 1 - prime();
    commander_ = out_[backup].in_command ? backup : out_[prime()].in_command ? prime() : nobody;
}

flight::Computer::Counters Computers::counters() const {
    const auto a = computers_[0].counters();
    const auto b = computers_[1].counters();
    return {std::max(a.cycles, b.cycles), a.overruns + b.overruns, a.mailbox_overflows + b.mailbox_overflows,
            a.unexpected_messages + b.unexpected_messages, a.resets + b.resets};
}

}  // namespace aeolis::simulation
