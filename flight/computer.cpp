// SPDX-License-Identifier: Apache-2.0
#include "flight/computer.hpp"

#include "flight/kernel/executive.hpp"

namespace aeolis::flight {
namespace {

bool in_command(const ComputerState& state) {
    // Second Chance is in command only from the cycle in which its EDL flies: before that its managers hold no commands
    // yet, and engines that receive no command for a cycle shut down.
    if (state.edl.stands_by()) return false;
    return state.load.role == Role::prime || state.cross_string.in_control();
}

/// Clears every output that a device could take for a command. Recording and telemetry stay.
void command_nothing(DeviceOutputs& out) {
    out.pyros.clear();
    out.switches.clear();
    out.telecom.clear();
    out.thrusters_enabled.reset();
    out.thrusters = {};
    out.engines = {};
    out.pay_out_bridle = false;
    out.tone.reset();
    out.cross_string.clear();
    out.designate_b_prime.reset();
}

}  // namespace

Computer::Computer(const Load& load, Sclk start) : state_(std::make_unique<ComputerState>(load, start)) {}
Computer::Computer(const Computer& other) : state_(std::make_unique<ComputerState>(*other.state_)) {}
Computer& Computer::operator=(const Computer& other) {
    *state_ = *other.state_;
    return *this;
}
Computer::Computer(Computer&&) noexcept = default;
Computer& Computer::operator=(Computer&&) noexcept = default;
Computer::~Computer() = default;

void Computer::step(const DeviceInputs& in, DeviceOutputs& out, CycleRunner* runner) {
    const Role designated = in.prime_is_b == (state_->load.string == String::b) ? Role::prime : Role::second_chance;
    if (designated != state_->load.role) start_anew(in.now, designated, state_->now);
    if (state_->runs_from && in.now < *state_->runs_from) {
        out.begin_cycle();
        command_nothing(out);
        out.in_command = false;
        out.wants_restart_record = !state_->forgets && in.now + seconds_per_tick >= *state_->runs_from;
        return;
    }
    if (state_->runs_from) state_->ran_from = state_->runs_from;
    state_->runs_from.reset();
    try {
        if (runner != nullptr)
            runner->cycle(*state_, in, out);
        else
            Executive{*state_}.cycle(in, out);
        out.in_command = in_command(*state_);
    } catch (const CheckFailed& bug) {
        // A bug on board stays on board: the computer restarts, and reports the reason in its first cycle. Outputs of
        // the failed cycle are not trusted. If the restored state fails at once, it is not restored a second time.
        const bool at_once = state_->ran_from && in.now - *state_->ran_from < restart_s;
        start_anew(in.now, designated, in.now - seconds_per_tick);
        state_->forgets = at_once;
        out.begin_cycle();
        state_->outbox.begin(ModuleId::sync, in.now, out);
        state_->outbox.event(evr::FATAL_CHECK_FAILED{.source_line = bug.line(), .resets = state_->load.resets});
        state_->outbox.send(ModuleId::mfsk, ToneRequest{tone::check_failed, in.now + restart_s});
        for (const Envelope& envelope : state_->outbox.sent()) state_->next_cycle.push_back(envelope);
        out.in_command = false;
    }
    if (!out.in_command) command_nothing(out);
}

void Computer::reset(Sclk now) {
    start_anew(now, state_->load.role, state_->now);
}

void Computer::start_anew(Sclk now, Role role, Sclk told_until) {
    Load load = state_->load;
    load.role = role;
    ++load.resets;
    if (!state_->runs_from) load.told_until = told_until;  // otherwise it has sent no state since its last start
    std::destroy_at(state_.get());
    std::construct_at(state_.get(), load, now);
    state_->runs_from = now + restart_s;
}

const gnc::Configuration& Computer::gnc_configuration() const {
    return state_->edl.configuration();
}

void Computer::replace_gnc(const gnc::Output& told) {
    state_->edl.replace_gnc(told);
}

void Computer::shift_navigation(const NavigationShift& by) {
    state_->edl.shift_navigation(by);
}

bool Computer::resume(std::span<const std::uint8_t> state_frame) {
    const auto state = StateFrame::read(state_frame);
    if (!state) return false;
    const auto deliver = [this](ModuleId to, const Message& message) {
        return state_->next_cycle.try_push_back({.from = ModuleId::cross_string, .to = to, .message = message});
    };
    bool delivered = deliver(ModuleId::units, UnitsSelected{state->header().units});
    state->in_parts([&](const StatePart& part) { delivered = delivered && deliver(ModuleId::edl, part); });
    return delivered && deliver(ModuleId::edl, Resume{ResumeReason::placed});
}

void Computer::tell_no_state() {
    state_->edl.tell_no_state();
}

bool Computer::may_take_over() const {
    return state_->cross_string.enabled();
}

Computer::Counters Computer::counters() const {
    return {state_->sync.cycles(), state_->sync.overruns(), state_->mailbox_overflows, state_->unexpected_messages,
            state_->load.resets};
}

}  // namespace aeolis::flight
