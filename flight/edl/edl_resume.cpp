// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/edl_main.hpp"
#include "flight/edl/solution.hpp"
#include "flight/explanation/explanation.hpp"

#include <utility>

// EdlMain resumes from a state of another source: its own from before a restart, or prime's. R32, R33
namespace aeolis::flight {

void EdlMain::tell_state(Sclk now, Outbox& out) {
    if (load_.role != Role::prime || revision_ == 0 || !tells_state_) return;
    const StateHeader header{.time = now,
                             .revision = revision_,
                             .begun = timeline_.begun(),
                             .separated = separated(now),
                             .touchdown = configuration_.touchdown_declared,
                             .units = units_};
    StateFrame::of(header, *this).in_parts([&](const StatePart& part) { out.send(ModuleId::cross_string, part); });
}

void EdlMain::on(const UnitsSelected& selected, Outbox&) {
    if (selected.units == units_) return;
    units_ = selected.units;
    ++revision_;
}

void EdlMain::on(const StatePart& part, Outbox&) {
    if (const auto state = assembly_.on(part)) state_of_another_ = state;
}

void EdlMain::on(const Resume& resume, Outbox& out) {
    const std::optional<StateFrame> state = std::exchange(state_of_another_, std::nullopt);
    const bool placed = resume.reason == ResumeReason::placed;
    if (!state || (timeline_.begun() && !placed)) return out.event(evr::STATE_UNREADABLE{});
    // A state of another build with the same dictionary is detected by its size, once it is read: then nothing of it
    // stays.
    const StateFrame before = StateFrame::of(state->header(), *this);
    if (!state->restore(*this)) {
        AEOLIS_CHECK(before.restore(*this));
        return out.event(evr::STATE_UNREADABLE{});
    }
    revision_ = state->header().revision + 1;
    unverified_.miss_some();
    fly_by_table(out);
    if (timeline_.begun()) out.send(ModuleId::units, EdlBegun{});
    if (placed)
        go_on(out);
    else if (resume.reason == ResumeReason::restart)
        restart(out.now(), out);
    else
        take_over(state->header(), out.now(), out);
}

void EdlMain::restart(Sclk now, Outbox& out) {
    // Decided by the last state that the other computer received: it takes over from just the states for which this one
    // stands by.
    if (const Sclk told = load_.told_until.value_or(now); timeline_.begun() && separated(told)) {
        stand_by(true, out);
        explain_stand_by(told, out);
        return out.event(evr::PRIME_STANDS_BY{});
    }
    out.send(ModuleId::mfsk, ToneRequest{tone::computer_started, now});
    tell_phase(out);
    if (parameters_) gnc_.set_solution(solution_of(*parameters_), now);  // the navigated state is out of date
    configuration_.pyros_armed = false;  // the pyro manager starts safe; the backtrack repeats the arming
    if (!timeline_.begun()) return;
    const TimepointId from = timeline_.current();
    if (timeline_.backtrack(now))
        out.event(evr::TIMELINE_BACKTRACKED{.timepoint = from.value, .backtrack = timeline_.current().value});
}

void EdlMain::stand_by(bool is, Outbox& out) {
    activity_ = is ? Activity::stands_by : Activity::flies;
    for (const ModuleId module : {ModuleId::mfsk, ModuleId::units}) out.send(module, StandBy{.over = !is});
}

void EdlMain::explain_stand_by(Sclk told, Outbox& out) const {
    gnc::Conditions conditions;
    conditions.push_back(is(Quantity::edl_enabled, timeline_.begun()));
    if (timeline_.triggered(timepoint::cruise_stage_separation))
        conditions.push_back(is(Quantity::separation_triggered, true));
    else
        conditions.push_back(at_most(Quantity::time_to_separation_s,
                                     *timeline_.anchor_time(anchor::cruise_stage_separation).get() - told, 0.0));
    out.record(explanation(Decision::stand_by, ExplanationVerdict::decided, 0, conditions.span()));
}

// The state is as old as the restart and the wait. Overdue timepoints fire at once, and navigation coasts over the gap.
// After touchdown prime could only do harm.
void EdlMain::on(const ResumePrimeCommand& command, Outbox& out) {
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(is(Quantity::prime_stands_by, activity_ == Activity::stands_by));
    outcome.conditions.push_back(is(Quantity::touchdown_declared, configuration_.touchdown_declared, false));
    if (!all_hold(outcome.conditions)) outcome.refused = CommandRefusal::wrong_phase;
    out.send(ModuleId::command_dispatcher, outcome);
    if (outcome.refused) return;
    stand_by(false, out);
    gnc_.catch_up({}, out.now() - seconds_per_tick);  // the readings of this cycle come with its turn
    (void)timeline_.backtrack(out.now());
    out.send(ModuleId::pyro, ArmPyros{configuration_.pyros_armed});
    ++revision_;
    out.event(evr::PRIME_RESUMES{.timepoint = timeline_.current().value});
    out.send(ModuleId::mfsk, ToneRequest{tone::computer_started, out.now()});
    tell_phase(out);
}

void EdlMain::take_over(const StateHeader& prime, Sclk now, Outbox& out) {
    if (activity_ != Activity::tracks) return;
    activity_ = Activity::flies;
    timeline_.await_nothing();
    for (; !recent_readings_.empty(); recent_readings_.pop()) {
        const ImuReadings& readings = recent_readings_.front();
        // The readings of this cycle are in gnc_inputs_ and are used in this cycle's GNC run.
        if (readings.now > prime.time && readings.now < now) gnc_.catch_up(readings.samples.span(), readings.now);
    }
    out.send(ModuleId::pyro, ArmPyros{configuration_.pyros_armed});
    out.event(evr::SECOND_CHANCE_TAKES_OVER{.silence_s = now - prime.time, .timepoint = timeline_.current().value});
    out.send(ModuleId::mfsk, ToneRequest{tone::taken_over, now});
    tell_phase(out);
    ++revision_;
}

// As a computer that takes over, but in the very cycle after the state: no reading is missing, though a reply under way
// may be.
void EdlMain::go_on(Outbox& out) {
    timeline_.await_nothing();
    out.send(ModuleId::pyro, ArmPyros{configuration_.pyros_armed});
    tell_phase(out);
}

void EdlMain::on(const SelectPrimeCommand& command, Outbox& out) {
    CommandOutcome outcome{.tag = command.tag};
    outcome.conditions.push_back(is(Quantity::edl_enabled, timeline_.begun(), false));
    if (timeline_.begun())
        outcome.refused = CommandRefusal::wrong_phase;
    else
        out.event(evr::PRIME_DESIGNATED{.string_number = static_cast<std::uint8_t>(command.string_b ? 1 : 0)});
    out.send(ModuleId::command_dispatcher, outcome);
    if (outcome.refused) return;
    designation_pending_ = true;
    out.send(ModuleId::cross_string, command);
}

}  // namespace aeolis::flight
