// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/edl_main.hpp"

#include "flight/edl/solution.hpp"
#include "flight/explanation/explanation.hpp"
#include "flight/timeline/actions.hpp"

#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace aeolis::flight {
namespace {

void answer(Outbox& out, const CommandTag& tag, std::optional<CommandRefusal> refused,
            std::span<const gnc::Condition> conditions) {
    out.send(ModuleId::command_dispatcher, CommandOutcome{tag, refused, gnc::telling(conditions)});
}

/// The bound that an unsafe change breaks, and by how much.
gnc::Condition broken_by(const timeline::Unsafe& unsafe) {
    using Why = timeline::Unsafe::Why;
    switch (unsafe.why) {
    case Why::decided_in_flight: return is(Quantity::decided_in_flight, true, false);
    case Why::not_navigated:
        return unsafe.by_s == 0.0 ? is(Quantity::entry_navigated, false)
                                  : at_most(Quantity::entry_apart_from_navigation_s, std::abs(unsafe.by_s),
                                            build_parameters.entry_moved_max_s);
    case Why::triggered_already: return is(Quantity::triggered_already, true, false);
    case Why::overdue: return at_most(Quantity::time_overdue_s, unsafe.by_s, 0.0);
    case Why::burst: return at_most(Quantity::burst_s, unsafe.by_s, 0.0);
    case Why::too_soon: return at_most(Quantity::too_soon_s, unsafe.by_s, 0.0);
    case Why::too_late: return at_most(Quantity::too_late_s, unsafe.by_s, 0.0);
    }
    return {};
}

// The event's enumeration has the values of the rule's.
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::decided_in_flight) == UnsafeChange::decided_in_flight);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::not_navigated) == UnsafeChange::not_navigated);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::triggered_already) == UnsafeChange::triggered_already);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::overdue) == UnsafeChange::overdue);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::burst) == UnsafeChange::burst);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::too_soon) == UnsafeChange::too_soon);
static_assert(static_cast<UnsafeChange>(timeline::Unsafe::Why::too_late) == UnsafeChange::too_late);

}  // namespace

EdlMain::EdlMain(const Load& load)
    : load_(load), activity_(load.role == Role::prime ? Activity::flies : Activity::tracks),
      timeline_(timeline_specs, anchor_specs, load.role == Role::second_chance), gnc_(load), table_(load.parameters) {}

// ---- the cycle -------------------------------------------------------------------------------------------------

void EdlMain::on(const Tick& tick, Outbox& out) {
    // GNC propagates to the tick's time, however far ahead it is.
    if (!(std::abs(tick.now - out.now()) <= table_.values().tick_apart_max_s)) {
        out.event(evr::UNEXPECTED_MESSAGE{.module_number = static_cast<std::uint8_t>(ModuleId::edl),
                                          .message_type = static_cast<std::uint8_t>(Message{tick}.index())});
        return out.send(ModuleId::sync, Confirm{ModuleId::edl});
    }
    if (activity_ != Activity::flies) return out.send(ModuleId::sync, Confirm{ModuleId::edl});
    const bool after_restart = cycle_count_++ == 0 && load_.resets > 0 && load_.role == Role::prime;
    if (after_restart) out.event(evr::COMPUTER_STARTED{.reset_count = reset_count()});
    timeline_.begin_cycle();
    watch_approach(tick.now, out);
    run_timeline(tick.now, out);
    run_gnc(tick.now, out);
    take_triggers(tick.now, out);
    run_timeline(tick.now, out);
    if (timeline_.limited(tick.now)) out.event(evr::FIRINGS_LIMITED{.timepoint = timeline_.current().value});
    explain_held(output_, held_, out);
    if (timeline_.begun() && !inhibited_) explain_held(table_.values(), timeline_, held_, out);
    update_phase(tick.now, out);
    // After a restart, the stored state arrives only in the second cycle: channels recorded before would describe a
    // vehicle that has not begun EDL.
    if (!after_restart) record_channels(tick.now, out);
    constraint_monitor_.report(out);
    tell_state(tick.now, out);
    out.send(ModuleId::sync, Confirm{ModuleId::edl});
}

void EdlMain::watch_approach(Sclk now, Outbox& out) {
    if (const bool is = late_cruise(now); is != was_late_cruise_) {
        was_late_cruise_ = is;
        if (is) out.event(evr::LATE_CRUISE_BEGUN{});
        if (is) out.send(ModuleId::mfsk, ToneRequest{tone::late_cruise, now});
    }
    if (const bool is = pre_edl(now); is != was_pre_edl_) {
        was_pre_edl_ = is;
        if (!is) out.event(evr::PRE_EDL_ENDED{});
    }
    if (inhibited_ && !was_pre_edl_) set_inhibited(false, out);
}

void EdlMain::run_timeline(Sclk now, Outbox& out) {
    if (inhibited_) return;
    ActionContext context{out, configuration_};
    Firings firings;
    const bool waited = timeline_.waiting().has_value();
    const bool navigated = configuration_.enabled;
    timeline_.pass(now, context, firings);
    if (configuration_.enabled && !navigated) tell_not_activated(out);
    // What was triggered is kept for a restart at once: its reply may be seconds away.
    if (!firings.empty() || timeline_.waiting().has_value() != waited) ++revision_;
    constraint_monitor_.watch(timeline_, firings.span());
    change_guard_.watch(timeline_, firings.span());
    for (const Firing& firing : firings) {
        out.record(packet::TimepointFired{.timepoint = firing.timepoint.value,
                                          .triggered_sclk = firing.triggered.seconds,
                                          .fired_sclk = firing.fired.seconds,
                                          .verdict = firing.verdict});
        tell_reply(firing, timeline_specs[firing.timepoint.value], out);
        unverified_.add(firing);
    }
    if (firings.empty() || !timeline_.finished()) return;
    out.event(evr::TIMELINE_COMPLETE{});
    out.send(ModuleId::cross_string, EdlFinished{});
    constraint_monitor_.summarise(out);
}

void EdlMain::run_gnc(Sclk now, Outbox& out) {
    gnc_inputs_.now = now;
    if (instead_of_gnc_)
        output_ = *std::exchange(instead_of_gnc_, std::nullopt);
    else
        gnc_.cycle(gnc_inputs_, configuration_, output_);
    if (output_.mode != mode_) {
        mode_ = output_.mode;
        out.event(evr::GNC_MODE_CHANGED{.gnc_mode = static_cast<GncMode>(mode_)});
    }
    gnc_inputs_.imu.clear();
    gnc_inputs_.engines.reset();
    gnc_inputs_.bridle.reset();
    if (!configuration_.enabled) return;
    out.send(ModuleId::thrusters, FireThrusters{output_.thrusters});
    if (configuration_.engines_primed) out.send(ModuleId::descent_engines, RunEngines{output_.engines});
    if (configuration_.radar_on) {
        const auto& p = output_.p_MoB_M_m;
        const double radius_m = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        out.send(
            ModuleId::edl_bg,
            NavigatedAttitude{output_.q_MB, {p[0] / radius_m, p[1] / radius_m, p[2] / radius_m}, output_.radar_locked});
    }
}

void EdlMain::take_triggers(Sclk now, Outbox& out) {
    for (const gnc::JudgedTrigger& fired : output_.triggers) {
        if (const auto started = anchor_of(fired.trigger)) timeline_.set_anchor_now(*started, now);
        announce(fired.trigger, output_, out);
        explain(fired, held_.take_suppressed(decision_of(fired.trigger)), out);
    }
    for (const gnc::ModeChange& change : output_.mode_changes) explain(change, out);
    if (output_.bank_reversal.number != 0) announce_bank_reversal(output_, out);
    if (!output_.sidestep.empty())
        out.record(explanation(Decision::sidestep, ExplanationVerdict::decided, 0, output_.sidestep.span()));
    peak_deceleration_.watch(table_.values(), output_, out);
    unverified_.watch(table_.values(), output_, bridle_m_, configuration_, out);
    gnc_health_.watch(table_.values(), output_, out);
}

void EdlMain::update_phase(Sclk now, Outbox& out) {
    const PhaseChanges changes =
        phase_.follow(output_.mode, configuration_,
                      {.late_cruise = late_cruise(now), .begun = timeline_.begun(), .pre_edl_over = !pre_edl(now)});
    if (changes.empty()) return;
    for (const PhaseChange& change : changes) explain(change, entry(), out);
    tell_phase(out);
    out.event(evr::EDL_PHASE_CHANGED{.phase = phase()});
}

void EdlMain::tell_phase(Outbox& out) const {
    for (const ModuleId module : {ModuleId::edl_comm, ModuleId::mfsk}) out.send(module, PhaseChanged{phase()});
}

// ---- inputs from the device managers ---------------------------------------------------------------------------

void EdlMain::on(const ImuReadings& readings, Outbox&) {
    if (activity_ == Activity::tracks) {
        if (recent_readings_.full()) recent_readings_.pop();
        (void)recent_readings_.try_push(readings);
    }
    gnc_inputs_.imu = readings.samples;
}

void EdlMain::on(const EngineReply& reply, Outbox&) {
    gnc_inputs_.engines = engines_ = reply;
}

void EdlMain::on(const BridleReply& reply, Outbox&) {
    gnc_inputs_.bridle = reply;
    bridle_m_ = reply.payed_out_m;
}

void EdlMain::on(const CruiseAttitude& attitude, Outbox&) {
    gnc_.on(attitude);
}

void EdlMain::on(const gnc::RadarSolution& solution, Outbox& out) {
    if (const auto decision = gnc_.on(solution)) explain(*decision, out);
}

void EdlMain::on(const ActionReply& reply, Outbox& out) {
    if (timeline_.reply(reply)) return;
    ActionContext context{out, configuration_};
    if (unverified_.on(reply, context)) ++revision_;
}

// ---- system fault protection ------------------------------------------------------------------------------------

void EdlMain::on(const InhibitEdl& wish, Outbox& out) {
    if (!wish.inhibited || pre_edl(out.now())) {
        refused_to_hold_ = false;
        return set_inhibited(wish.inhibited, out);
    }
    if (!refused_to_hold_) out.event(evr::FAULT_PROTECTION_TOO_LATE{});
    refused_to_hold_ = true;
}

void EdlMain::set_inhibited(bool inhibited, Outbox& out) {
    if (inhibited == inhibited_) return;
    inhibited_ = inhibited;
    if (inhibited)
        out.event(evr::FAULT_PROTECTION_INHIBITS_EDL{});
    else
        out.event(evr::FAULT_PROTECTION_RELEASES_EDL{});
    out.send(ModuleId::mfsk, ToneRequest{inhibited ? tone::fault_inhibit : tone::fault_inhibit_over, out.now()});
}

// ---- commands --------------------------------------------------------------------------------------------------

bool EdlMain::late_cruise(Sclk now) const {
    return now >= entry() + MaybeOffset{-build_parameters.late_cruise_before_entry_s};
}

// Until ground has sent the time of entry, EDL is still far off.
bool EdlMain::pre_edl(Sclk now) const {
    return !(now >= timeline_.anchor_time(anchor::pre_edl_end));
}

// The separation may be fired late, or before its anchor: it counts once it is due or fired, whichever is first.
bool EdlMain::separated(Sclk now) const {
    return now >= timeline_.anchor_time(anchor::cruise_stage_separation) ||
           timeline_.triggered(timepoint::cruise_stage_separation);
}

bool EdlMain::too_late(Sclk now) const {
    return now >= timeline_.first_desired() + MaybeOffset{-build_parameters.do_edl_margin_s};
}

void EdlMain::on(const ParametersUpdate& update, Outbox& out) {
    // Once GNC navigates by itself, a solution from Earth is older than its own.
    FixedVector<gnc::Condition, SolutionConditions::capacity() + gnc::Conditions::capacity() + 2> conditions;
    conditions.push_back(is(Quantity::gnc_enabled, configuration_.enabled, false));
    if (configuration_.enabled) return answer(out, update.tag, CommandRefusal::wrong_phase, conditions);
    const SolutionConditions of_solution = conditions_of(update.parameters, out.now(), table_.built_in());
    if (!all_hold(of_solution)) return answer(out, update.tag, CommandRefusal::bad_argument, of_solution);
    const Sclk entry = Sclk::from_ticks(std::llround(update.parameters.entry_sclk * 64.0));
    const auto navigated = navigated_entry(update.parameters);
    if (const auto unsafe = unsafe_entry(entry, navigated ? MaybeTime{navigated->at} : MaybeTime{}, out.now()))
        return refuse(*unsafe, update.tag, out);
    const gnc::Conditions of_target = navigated ? target_conditions(update.parameters, *navigated) : gnc::Conditions{};
    if (!all_hold(of_target)) return answer(out, update.tag, CommandRefusal::bad_argument, of_target);
    if (navigated)
        conditions.push_back(at_most(Quantity::entry_apart_from_navigation_s, std::abs(entry - navigated->at),
                                     build_parameters.entry_moved_max_s));
    conditions.append(of_solution.span());
    conditions.append(of_target.span());
    ++revision_;
    parameters_ = update.parameters;
    gnc_.set_solution(solution_of(*parameters_), out.now());
    AEOLIS_CHECK(timeline_.set_anchor_offset(anchor::entry, entry.seconds));
    timeline_.compute_anchors();
    out.record(parameters_held());
    out.event(evr::EDL_PARAMETERS_ACCEPTED{.solution_id = parameters_->solution_id});
    out.send(ModuleId::mfsk, ToneRequest{tone::parameters_accepted, out.now()});
    answer(out, update.tag, std::nullopt, conditions);
}

void EdlMain::on(const DoEdlCommand& command, Outbox& out) {
    std::optional<CommandRefusal> refused;
    if (!parameters_)
        refused = CommandRefusal::no_parameters;
    else if (timeline_.begun())
        refused = CommandRefusal::already_running;
    else if (designation_pending_)
        refused = CommandRefusal::wrong_phase;
    else if (inhibited_)
        refused = CommandRefusal::inhibited;
    else if (!late_cruise(out.now()))
        refused = CommandRefusal::too_early;
    else if (too_late(out.now()))
        refused = CommandRefusal::too_late;
    FixedVector<gnc::Condition, 8> conditions;
    conditions.push_back(is(Quantity::parameters_received, parameters_.has_value()));
    if (entry().defined())
        conditions.push_back(at_most(Quantity::time_to_uplinked_entry_s, *entry().get() - out.now(),
                                     build_parameters.late_cruise_before_entry_s));
    if (timeline_.first_desired().defined())
        conditions.push_back(above(Quantity::time_to_first_timepoint_s, *timeline_.first_desired().get() - out.now(),
                                   build_parameters.do_edl_margin_s));
    conditions.push_back(is(Quantity::fault_inhibit, inhibited_, false));
    conditions.push_back(is(Quantity::edl_enabled, timeline_.begun(), false));
    conditions.push_back(is(Quantity::restart_pending, designation_pending_, false));
    if (!refused) {
        timeline_.begin(out.now());
        constraint_monitor_.note(Moment::of_do_edl(), out.now());
        change_guard_.begin(out.now());
        ++revision_;
        out.event(evr::EDL_BEGUN{});
        out.send(ModuleId::units, EdlBegun{});
        out.send(ModuleId::mfsk, ToneRequest{tone::edl_enabled, out.now()});
    }
    answer(out, command.tag, refused, conditions);
}

void EdlMain::on(const SetTimepointOffsetCommand& command, Outbox& out) {
    const auto& arguments = command.arguments;
    const TimepointId id{arguments.timepoint};
    const bool in_ticks =
        is_multiple_of_tick(arguments.desired_offset_s) && is_multiple_of_tick(arguments.minimum_offset_s);
    const std::array conditions{is(Quantity::offsets_in_ticks, in_ticks),
                                below(Quantity::row_number, id.value, static_cast<double>(timeline_.rows().size()))};
    if (!gnc::all_hold(conditions)) return answer(out, command.tag, CommandRefusal::bad_argument, conditions);
    const timeline::TimepointChange change{id, arguments.desired_offset_s, arguments.minimum_offset_s};
    if (const auto unsafe = change_guard_.judge(timeline_, change, out.now())) return refuse(*unsafe, command.tag, out);
    AEOLIS_CHECK(timeline_.set_timepoint_offsets(id, change.desired_s, change.minimum_s));
    ++revision_;
    out.event(evr::TIMEPOINT_OFFSET_CHANGED{.timepoint = arguments.timepoint,
                                            .desired_offset_s = arguments.desired_offset_s,
                                            .minimum_offset_s = arguments.minimum_offset_s});
    answer(out, command.tag, std::nullopt, conditions);
}

void EdlMain::on(const SetAnchorOffsetCommand& command, Outbox& out) {
    const auto& arguments = command.arguments;
    const AnchorId id{arguments.anchor};
    const auto anchors = timeline_.anchors();
    const std::array conditions{
        is(Quantity::offsets_in_ticks, is_multiple_of_tick(arguments.offset_s)),
        below(Quantity::row_number, id.value, static_cast<double>(anchors.size())),
        is(Quantity::root_anchor, id.value < anchors.size() && !anchors[id.value].parent, false)};
    if (!gnc::all_hold(conditions)) return answer(out, command.tag, CommandRefusal::bad_argument, conditions);
    const MaybeTime held = parameters_ ? MaybeTime{Sclk{parameters_->entry_sclk}} : MaybeTime{};
    const auto unsafe = id == anchor::entry
                            ? unsafe_entry(Sclk{arguments.offset_s}, held, out.now())
                            : change_guard_.judge(timeline_, timeline::AnchorChange{id, arguments.offset_s}, out.now());
    if (unsafe) return refuse(*unsafe, command.tag, out);
    AEOLIS_CHECK(timeline_.set_anchor_offset(id, arguments.offset_s));
    ++revision_;
    out.event(evr::ANCHOR_OFFSET_CHANGED{.anchor = arguments.anchor, .offset_s = arguments.offset_s});
    answer(out, command.tag, std::nullopt, conditions);
}

std::optional<timeline::Unsafe> EdlMain::unsafe_entry(Sclk said, MaybeTime navigated, Sclk now) {
    if (auto unsafe = timeline::unsafe_entry(anchor::entry, said, navigated, build_parameters.entry_moved_max_s))
        return unsafe;
    // The first parameters move nothing: "do edl" comes later.
    if (!entry().defined()) return std::nullopt;
    return change_guard_.judge(timeline_, timeline::AnchorChange{anchor::entry, said.seconds}, now);
}

void EdlMain::refuse(const timeline::Unsafe& unsafe, const CommandTag& tag, Outbox& out) {
    const auto why = static_cast<UnsafeChange>(unsafe.why);
    const bool of_anchor = unsafe.what.kind == Moment::Kind::anchor;
    if (of_anchor)
        out.event(
            evr::ANCHOR_CHANGE_REFUSED{.anchor = unsafe.what.index, .unsafe_change = why, .unsafe_by_s = unsafe.by_s});
    else
        out.event(evr::TIMELINE_CHANGE_REFUSED{
            .timepoint = unsafe.what.index, .unsafe_change = why, .unsafe_by_s = unsafe.by_s});
    const std::array conditions{
        broken_by(unsafe), names(of_anchor ? Quantity::unsafe_anchor : Quantity::unsafe_timepoint, unsafe.what.index)};
    answer(out, tag, CommandRefusal::unsafe_change, conditions);
}

}  // namespace aeolis::flight
