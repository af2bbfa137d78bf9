// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/names.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timepoint.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace aeolis::flight {

/// What an action may use: messages to device managers, and the configuration for GNC. R5, R17, R26
class ActionContext {
  public:
    ActionContext(Outbox& out, gnc::Configuration& configuration) : out_(out), configuration_(configuration) {}

    void begin(const TimepointSpec& row) {
        awaited_ = {};
        fact_ = {};
        owner_ = row.owner;
        reply_timeout_s_ = row.reply_timeout_s.value_or(0.0);
    }
    /// Fires a pyro; `fact` is the change of the configuration once it has fired.
    void fire(PyroId pyro, gnc::Fact fact = {});
    void arm_pyros(bool armed);
    void pay_out_bridle();
    void set_switch(SwitchId id, bool on);
    void enable_thrusters(bool enabled);
    void close_recording();
    void await(const ActionReply& reply) { awaited_ = reply; }
    void request_tone(ToneId tone);
    /// Sends the event and the tone of a row whose action is done.
    void announce(const TimepointSpec& row);

    Outbox& out() { return out_; }
    gnc::Configuration& configuration() { return configuration_; }
    Sclk now() const { return out_.now(); }
    /// The reply that the last action run asked for.
    const ActionReply& awaited() const { return awaited_; }
    gnc::Fact fact() const { return fact_; }

  private:
    Outbox& out_;
    gnc::Configuration& configuration_;
    /// Sends to a device manager, which must be the owner of the action. R5
    template <typename M>
    void command(ModuleId manager, const M& message) {
        AEOLIS_CHECK(!owner_ || *owner_ == manager);
        out_.send(manager, message);
    }

    ActionReply awaited_;
    gnc::Fact fact_{};
    std::optional<ModuleId> owner_;  // of the current action
    double reply_timeout_s_ = 0.0;   // of its row
};

/// Announces a timepoint's action as done; the event column of the timeline names the events.
template <typename Evr>
void announce(ActionContext& context) {
    context.out().event(Evr{});
}

/// An action of timeline.csv: its owner, the only module that it commands, and what it does. R5, R40
/// It commands the spacecraft, and changes GNC's configuration at once or when the action is done.
struct Action {
    std::string_view name;
    ModuleId owner;
    ActionFunction run;
};

inline constexpr std::array actions{
    // power and telecom
    Action{"power_on_descent_imu", ModuleId::power,
           [](ActionContext& on) { on.set_switch(SwitchId::descent_imu, true); }},
    Action{"power_on_radar", ModuleId::power, [](ActionContext& on) { on.set_switch(SwitchId::radar, true); }},
    Action{"power_off_radar", ModuleId::power,
           [](ActionContext& on) {
               on.configuration().radar_on = false;
               on.set_switch(SwitchId::radar, false);
           }},
    Action{"select_entry_antenna", ModuleId::telecom,
           [](ActionContext& on) { on.set_switch(SwitchId::entry_antenna, true); }},
    Action{"select_parachute_antenna", ModuleId::telecom,
           [](ActionContext& on) { on.set_switch(SwitchId::parachute_antenna, true); }},
    Action{"start_uhf", ModuleId::telecom, [](ActionContext& on) { on.set_switch(SwitchId::uhf, true); }},
    Action{"start_x_band_tones", ModuleId::telecom,
           [](ActionContext& on) { on.set_switch(SwitchId::x_band_tones, true); }},
    Action{"stop_uhf", ModuleId::telecom, [](ActionContext& on) { on.set_switch(SwitchId::uhf, false); }},
    Action{"close_recording", ModuleId::edl_comm, [](ActionContext& on) { on.close_recording(); }},

    // leaving the cruise stage
    Action{"vent_coolant", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::coolant_vent); }},
    Action{"open_pressurant_valve_1", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::pressurant_valve_1); }},
    Action{"open_pressurant_valve_2", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::pressurant_valve_2); }},
    Action{"activate_thermal_batteries", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::thermal_batteries); }},
    Action{"cut_cruise_cables", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::cruise_cable_cutter); }},
    Action{"fire_cruise_stage_separation", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::cruise_stage_separation, gnc::Fact::cruise_stage_gone); }},
    Action{"enable_gnc", ModuleId::edl, [](ActionContext& on) { on.configuration().enabled = true; }},
    Action{"warm_thrusters", ModuleId::power,
           [](ActionContext& on) { on.set_switch(SwitchId::thruster_heaters, true); }},
    Action{"start_detumble", ModuleId::thrusters, [](ActionContext& on) { on.enable_thrusters(true); }},
    Action{"start_turn_to_entry", ModuleId::edl, [](ActionContext& on) { on.configuration().turning_to_entry = true; }},
    Action{"jettison_cruise_balance_1", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::cruise_balance_1); }},
    Action{"jettison_cruise_balance_2", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::cruise_balance_2); }},

    // entry
    Action{"start_guidance_wait", ModuleId::edl, [](ActionContext& on) { on.configuration().guidance_armed = true; }},
    Action{"start_entry_guidance", ModuleId::edl, [](ActionContext& on) { on.configuration().sufr_allowed = true; }},
    Action{"jettison_balance_1", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::entry_balance_1); }},
    Action{"jettison_balance_2", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::entry_balance_2); }},
    Action{"jettison_balance_3", ModuleId::pyro, [](ActionContext& on) { on.fire(PyroId::entry_balance_3); }},
    Action{"arm_pyros", ModuleId::pyro, [](ActionContext& on) { on.arm_pyros(true); }},
    Action{"safe_pyros", ModuleId::pyro, [](ActionContext& on) { on.arm_pyros(false); }},

    // parachute
    Action{"fire_parachute_mortar", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::parachute_mortar, gnc::Fact::parachute_out); }},
    Action{"disable_thrusters", ModuleId::thrusters,
           [](ActionContext& on) {
               on.configuration().thrusters_on_time.reset();  // from now on they need not obey, whatever is answered
               on.enable_thrusters(false);
           }},
    Action{"enable_thrusters", ModuleId::thrusters, [](ActionContext& on) { on.enable_thrusters(true); }},
    Action{"fire_heatshield_separation", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::heatshield_separation, gnc::Fact::heatshield_gone); }},
    Action{"start_radar_processing", ModuleId::edl, [](ActionContext& on) { on.configuration().radar_on = true; }},
    Action{"open_engine_valves", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::engine_valves, gnc::Fact::engines_primed); }},

    // powered descent and sky crane
    Action{"fire_backshell_separation", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::backshell_separation, gnc::Fact::backshell_gone); }},
    Action{"ignite_engines", ModuleId::descent_engines,
           [](ActionContext& on) {
               on.configuration().engines_ignited = true;
               on.await({ReplyKind::engines, 1});
           }},
    Action{"start_sky_crane", ModuleId::edl, [](ActionContext& on) { on.configuration().sky_crane_started = true; }},
    Action{"fire_rover_separation", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::rover_separation, gnc::Fact::rover_separated); }},
    Action{"release_bridle", ModuleId::descent_engines, [](ActionContext& on) { on.pay_out_bridle(); }},
    Action{"enable_touchdown_logic", ModuleId::edl,
           [](ActionContext& on) { on.configuration().touchdown_logic_ready = true; }},
    Action{"declare_touchdown", ModuleId::edl, [](ActionContext& on) { on.configuration().touchdown_declared = true; }},
    Action{"fire_bridle_cutters", ModuleId::pyro,
           [](ActionContext& on) { on.fire(PyroId::bridle_cutter, gnc::Fact::bridle_cut); }},
    Action{"start_flyaway", ModuleId::edl, [](ActionContext& on) { on.configuration().flyaway_started = true; }},
    Action{"stop_engines", ModuleId::descent_engines,
           [](ActionContext& on) {
               on.configuration().engines_off = true;
               on.await({ReplyKind::engines, 0});
           }},
};

/// Left undefined, so that the compiler names both.
template <Name misspelt, Name nearest>
struct ColumnActionNamesNoAction;

/// The action of that name. A misspelt one does not compile, at its row of timeline.csv, and the error has the nearest
/// name.
template <Name name>
consteval const Action& action_named() {
    constexpr auto found = std::ranges::find(actions, name.view(), &Action::name);
    if constexpr (found == actions.end())
        static_assert(sizeof(ColumnActionNamesNoAction<name, nearest(name.view(), actions, &Action::name)>) != 0);
    return found == actions.end() ? actions.front() : *found;
}

}  // namespace aeolis::flight
