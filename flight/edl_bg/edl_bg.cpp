// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_bg/edl_bg.hpp"

#include "common/check.hpp"
#include "flight/edl/parameter_table.hpp"
#include "flight/edl/solution.hpp"

namespace aeolis::flight {

void EdlBg::on(const RadarReturns& returns, Outbox&) {
    latest_ = returns;
}

// The attitude is sent after GNC's cycle, so it is the one at the tick of the returns. A lag of one cycle would cost
// metres of altitude while the vehicle turns in the powered approach.
void EdlBg::on(const NavigatedAttitude& attitude, Outbox& out) {
    if (!navigated_) solved_at_ = out.now();
    navigated_ = true;
    attitude_at_ = out.now();
    radar_locked_ = attitude.radar_locked;
    batch_.on(parameters_.values(), latest_.now, latest_.beams.span(),
              gnc::Quaternion{attitude.q_MB[0], attitude.q_MB[1], attitude.q_MB[2], attitude.q_MB[3]},
              gnc::Vector3{attitude.up_M[0], attitude.up_M[1], attitude.up_M[2]});
    latest_.beams.clear();
}

void EdlBg::on(const SetParametersCommand& command, Outbox& out) {
    const auto conditions = conditions_of(command.arguments, out.now(), as_built_);
    if (all_hold(conditions))
        out.send(ModuleId::edl, ParametersUpdate{command.tag, command.arguments});
    else
        out.send(ModuleId::command_dispatcher,
                 CommandOutcome{command.tag, CommandRefusal::bad_argument, gnc::telling(conditions)});
}

void EdlBg::on(const StageParameterCommand& command, Outbox& out) {
    const auto conditions = conditions_of(command.arguments);
    if (all_hold(conditions))
        out.send(ModuleId::edl, command);
    else
        out.send(ModuleId::command_dispatcher,
                 CommandOutcome{command.tag, refusal_of(conditions), gnc::telling(conditions)});
}

void EdlBg::on(const ActivateParametersCommand& command, Outbox& out) {
    out.send(ModuleId::edl, command);
}

void EdlBg::on(const DiscardParametersCommand& command, Outbox& out) {
    out.send(ModuleId::edl, command);
}

void EdlBg::on(const DumpParametersCommand& command, Outbox& out) {
    out.send(ModuleId::edl, command);
}

void EdlBg::on(const ParameterPart& part, Outbox&) {
    parameters_.on(part);
}

void EdlBg::on(const ClockTick& tick, Outbox& out) {
    if (at_resolution(tick.now, 1) != tick.now || !navigated_) return;
    const auto solution = batch_.solve(parameters_.values(), tick.now);
    if (!solution) return watch_radar(tick.now, out);
    solved_at_ = tick.now;
    radar_lost_ = false;
    ++solutions_;
    out.send(ModuleId::edl, *solution);
    out.record(packet::GncRadar{.radar_altitude_m = static_cast<float>(solution->altitude_m),
                                .radar_velocity_x_mps = static_cast<float>(solution->v_MB_M_mps[0]),
                                .radar_velocity_y_mps = static_cast<float>(solution->v_MB_M_mps[1]),
                                .radar_velocity_z_mps = static_cast<float>(solution->v_MB_M_mps[2]),
                                .radar_solutions = solutions_,
                                .radar_beams = solution->beams,
                                .radar_locked = radar_locked_});
}

void EdlBg::watch_radar(Sclk now, Outbox& out) {
    AEOLIS_CHECK(navigated_);  // before, there is no time from which a gap counts
    const bool wanted = now - attitude_at_ < 1.0;
    const double gap_s = now - solved_at_;
    // Under the parachute the vehicle may first swing so far that its beams miss the ground: the first solution may
    // take longer.
    const Parameters& parameters = parameters_.values();
    const double most_s = solutions_ > 0 ? parameters.radar_gap_max_s : parameters.radar_patience_s;
    if (!wanted || radar_lost_ || gap_s < most_s) return;
    radar_lost_ = true;
    out.event(evr::RADAR_LOST{.gap_s = gap_s});
    out.send(ModuleId::mfsk, ToneRequest{tone::radar_lost, now});
}

}  // namespace aeolis::flight
