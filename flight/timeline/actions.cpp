// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/actions.hpp"

namespace aeolis::flight {

void ActionContext::fire(PyroId pyro, gnc::Fact fact) {
    command(ModuleId::pyro, FirePyro{pyro, now() + reply_timeout_s_});
    await({ReplyKind::pyro, static_cast<std::uint8_t>(pyro)});
    fact_ = fact;
}

void ActionContext::arm_pyros(bool armed) {
    command(ModuleId::pyro, ArmPyros{armed});
    await({ReplyKind::arming, static_cast<std::uint8_t>(armed)});
    fact_ = armed ? gnc::Fact::pyros_armed : gnc::Fact::pyros_safe;
}

void ActionContext::set_switch(SwitchId id, bool on) {
    command(is_telecom(id) ? ModuleId::telecom : ModuleId::power, SetSwitch{id, on});
    await({ReplyKind::device_switch, static_cast<std::uint8_t>(id), Evidence::none, on});
}

void ActionContext::enable_thrusters(bool enabled) {
    command(ModuleId::thrusters, EnableThrusters{enabled});
    await({ReplyKind::thrusters, 0, Evidence::none, enabled});
}

void ActionContext::pay_out_bridle() {
    command(ModuleId::descent_engines, PayOutBridle{});
    await({ReplyKind::bridle, 0});
}

void ActionContext::close_recording() {
    command(ModuleId::edl_comm, CloseRecording{});
    await({ReplyKind::recording, 0});
}

void ActionContext::request_tone(ToneId tone) {
    out_.send(ModuleId::mfsk, ToneRequest{tone, now()});
}

void ActionContext::announce(const TimepointSpec& row) {
    if (row.event) row.event(*this);
    if (row.tone) request_tone(*row.tone);
}

namespace actions {

void power_on_descent_imu(ActionContext& context) {
    context.set_switch(SwitchId::descent_imu, true);
}
void power_on_radar(ActionContext& context) {
    context.set_switch(SwitchId::radar, true);
}
void power_off_radar(ActionContext& context) {
    context.configuration().radar_on = false;
    context.set_switch(SwitchId::radar, false);
}
void select_entry_antenna(ActionContext& context) {
    context.set_switch(SwitchId::entry_antenna, true);
}
void select_parachute_antenna(ActionContext& context) {
    context.set_switch(SwitchId::parachute_antenna, true);
}
void start_uhf(ActionContext& context) {
    context.set_switch(SwitchId::uhf, true);
}
void stop_uhf(ActionContext& context) {
    context.set_switch(SwitchId::uhf, false);
}
void close_recording(ActionContext& context) {
    context.close_recording();
}

void vent_coolant(ActionContext& context) {
    context.fire(PyroId::coolant_vent);
}
void cut_cruise_cables(ActionContext& context) {
    context.fire(PyroId::cruise_cable_cutter);
}
void fire_cruise_stage_separation(ActionContext& context) {
    context.fire(PyroId::cruise_stage_separation, gnc::Fact::cruise_stage_gone);
}
void enable_gnc(ActionContext& context) {
    context.configuration().enabled = true;
}
void warm_thrusters(ActionContext& context) {
    context.set_switch(SwitchId::thruster_heaters, true);
}
void start_detumble(ActionContext& context) {
    context.enable_thrusters(true);
}
void start_turn_to_entry(ActionContext& context) {
    context.configuration().turning_to_entry = true;
}
void jettison_cruise_balance_1(ActionContext& context) {
    context.fire(PyroId::cruise_balance_1);
}
void jettison_cruise_balance_2(ActionContext& context) {
    context.fire(PyroId::cruise_balance_2);
}

void start_guidance_wait(ActionContext& context) {
    context.configuration().guidance_armed = true;
}
void start_entry_guidance(ActionContext& context) {
    context.configuration().sufr_allowed = true;
}
void jettison_balance_1(ActionContext& context) {
    context.fire(PyroId::entry_balance_1);
}
void jettison_balance_2(ActionContext& context) {
    context.fire(PyroId::entry_balance_2);
}
void jettison_balance_3(ActionContext& context) {
    context.fire(PyroId::entry_balance_3);
}
void arm_pyros(ActionContext& context) {
    context.arm_pyros(true);
}
void safe_pyros(ActionContext& context) {
    context.arm_pyros(false);
}

void fire_parachute_mortar(ActionContext& context) {
    context.fire(PyroId::parachute_mortar, gnc::Fact::parachute_out);
}
void disable_thrusters(ActionContext& context) {
    context.enable_thrusters(false);
}
void enable_thrusters(ActionContext& context) {
    context.enable_thrusters(true);
}
void fire_heatshield_separation(ActionContext& context) {
    context.fire(PyroId::heatshield_separation, gnc::Fact::heatshield_gone);
}
void start_radar_processing(ActionContext& context) {
    context.configuration().radar_on = true;
}
void open_engine_valves(ActionContext& context) {
    context.fire(PyroId::engine_valves, gnc::Fact::engines_primed);
}

void fire_backshell_separation(ActionContext& context) {
    context.fire(PyroId::backshell_separation, gnc::Fact::backshell_gone);
}
void ignite_engines(ActionContext& context) {
    context.configuration().engines_ignited = true;
    context.await({ReplyKind::engines, 1});
}
void start_sky_crane(ActionContext& context) {
    context.configuration().sky_crane_started = true;
}
void fire_rover_separation(ActionContext& context) {
    context.fire(PyroId::rover_separation, gnc::Fact::rover_separated);
}
void release_bridle(ActionContext& context) {
    context.pay_out_bridle();
}
void enable_touchdown_logic(ActionContext& context) {
    context.configuration().touchdown_logic_ready = true;
}
void declare_touchdown(ActionContext& context) {
    context.configuration().touchdown_declared = true;
}
void fire_bridle_cutters(ActionContext& context) {
    context.fire(PyroId::bridle_cutter, gnc::Fact::bridle_cut);
}
void start_flyaway(ActionContext& context) {
    context.configuration().flyaway_started = true;
}
void stop_engines(ActionContext& context) {
    context.configuration().engines_off = true;
    context.await({ReplyKind::engines, 0});
}

}  // namespace actions
}  // namespace aeolis::flight
