// SPDX-License-Identifier: Apache-2.0
#include "flight/cross_string/cross_string.hpp"

#include "flight/explanation/explanation.hpp"

#include <array>

namespace aeolis::flight {
namespace {

constexpr double answer_first_s = 2.0;      // chosen: ground receives the answer before both computers restart
constexpr std::int64_t status_every_s = 5;  // chosen: the backup's own telemetry takes a hundredth of the link

void resume(const StateFrame& state, ResumeReason reason, Outbox& out) {
    state.in_parts([&](const StatePart& part) { out.send(ModuleId::edl, part); });
    out.send(ModuleId::units, UnitsSelected{state.header().units});
    out.send(ModuleId::edl, Resume{reason});
    out.send(ModuleId::command_dispatcher, Resume{reason});
}

}  // namespace

void CrossString::put(StateOctets& line, std::span<const std::uint8_t> state) {
    line.clear();  // of two states in one cycle, only the later is kept
    line.append(state);
}

void CrossString::tell(const StatePart& part, Outbox& out) {
    if (!assembly_.take(part)) return;
    put(out.bus().cross_string, assembly_.octets());
    const StateHeader header = StateFrame::header_of(assembly_.octets());
    if (header.revision == kept_revision_ && header.time - kept_at_ < keep_every_s) return;
    kept_revision_ = header.revision;
    kept_at_ = header.time;
    put(out.bus().restart_record, assembly_.octets());
}

void CrossString::on(const StatePart& part, Outbox& out) {
    if (load_role_ == Role::prime) return tell(part, out);
    heard_ = out.now();
    if (in_control_) return;
    if (!assembly_.take(part) || !latest_.replace(assembly_.octets())) return;
    too_old_told_ = false;
    const StateHeader prime = latest_.header();
    // The managers must address the right units from the first command on.
    if (prime.units != told_units_) {
        told_units_ = prime.units;
        out.send(ModuleId::units, UnitsSelected{prime.units});
    }
    if (prime.touchdown && !off_) turn_off(out);
}

void CrossString::on(const StoredStatePart& stored, Outbox& out) {
    if (load_role_ != Role::prime) return;
    if (const auto state = assembly_.on(stored.part))
        resume(*state, ResumeReason::restart, out);
    else if (stored.part.index + 1U == stored.part.count)
        out.event(evr::STATE_UNREADABLE{});
}

void CrossString::on(const EnableSecondChanceCommand& command, Outbox& out) {
    if (load_role_ == Role::prime) return;
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(is(Quantity::second_chance_off, off_, false));
    outcome.conditions.push_back(is(Quantity::second_chance_in_control, in_control_, false));
    if (!all_hold(outcome.conditions)) outcome.refused = CommandRefusal::wrong_phase;
    if (!outcome.refused) {
        enabled_ = command.enabled;
        if (enabled_)
            out.event(evr::SECOND_CHANCE_ENABLED{});
        else
            out.event(evr::SECOND_CHANCE_DISABLED{});
    }
    out.send(ModuleId::command_dispatcher, outcome);
}

void CrossString::on(const SelectPrimeCommand& command, Outbox& out) {
    if (load_role_ != Role::prime) return;
    designated_b_ = command.string_b;
    designate_at_ = out.now() + answer_first_s;
}

void CrossString::on(const OtherRunsBuses& seen, Outbox&) {
    other_ran_buses_ = seen.now;
}

// One computer flies: what the other one does cannot be stopped, nor its bus shared.
void CrossString::on(const ResumePrimeCommand& command, Outbox& out) {
    if (load_role_ != Role::prime) return;
    if (other_ran_buses_) {
        const auto silent = above(Quantity::other_computer_silent_s, out.now() - *other_ran_buses_, prime_silent_s);
        if (!silent.holds) {
            CommandOutcome outcome{.tag = command.tag, .refused = CommandRefusal::wrong_phase};
            outcome.conditions.push_back(silent);
            return out.send(ModuleId::command_dispatcher, outcome);
        }
    }
    out.send(ModuleId::edl, command);
}

bool CrossString::may_take_over(Sclk now, Outbox& out) {
    if (!enabled_ || off_ || in_control_ || latest_.empty() || !heard_) return false;
    const StateHeader prime = latest_.header();
    const auto silent = above(Quantity::prime_silent_s, now - *heard_, prime_silent_s);
    const auto separated = is(Quantity::cruise_stage_separated, prime.begun && prime.separated);
    const auto in_flight = is(Quantity::touchdown_declared, prime.touchdown, false);
    const auto fresh = at_most(Quantity::state_age_s, now - prime.time, state_age_max_s);
    const bool due = silent.holds && separated.holds && in_flight.holds;
    if (!due || (!fresh.holds && too_old_told_)) return false;
    const std::array conditions{silent, fresh, separated, in_flight};
    out.record(explanation(Decision::take_over, fresh.holds ? ExplanationVerdict::decided : ExplanationVerdict::refused,
                           0, conditions));
    if (fresh.holds) return true;
    too_old_told_ = true;
    out.event(evr::SECOND_CHANCE_STATE_TOO_OLD{.silence_s = now - prime.time});
    return false;
}

void CrossString::on(const ClockTick& tick, Outbox& out) {
    if (load_role_ == Role::prime) {
        if (!designate_at_ || tick.now < *designate_at_) return;
        designate_at_.reset();
        out.bus().designate_b_prime = designated_b_;
        return;
    }
    if (may_take_over(tick.now, out)) {
        in_control_ = true;
        resume(latest_, ResumeReason::take_over, out);
    }
    if (at_resolution(tick.now, 1) == tick.now && tick.now.ticks() / 64 % status_every_s == 0)
        out.record(packet::SecondChanceStatus{.second_chance_enabled = enabled_,
                                              .prime_heard = heard_ && tick.now - *heard_ <= prime_silent_s,
                                              .second_chance_in_control = in_control(),
                                              .second_chance_off = off_,
                                              .state_revision = latest_.empty() ? 0 : latest_.header().revision});
}

void CrossString::on(const EdlFinished&, Outbox& out) {
    if (load_role_ == Role::second_chance && !off_) turn_off(out);
}

void CrossString::turn_off(Outbox& out) {
    off_ = true;
    out.event(evr::SECOND_CHANCE_OFF{});
}

}  // namespace aeolis::flight
