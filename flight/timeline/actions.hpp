// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timepoint.hpp"

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

/// The actions that timeline.csv names.
/// One per line: the spacecraft's action, and the change of GNC's configuration, at once or when the action is done.
namespace actions {
// power and telecom
void power_on_descent_imu(ActionContext& context);
void power_on_radar(ActionContext& context);
void power_off_radar(ActionContext& context);
void select_entry_antenna(ActionContext& context);
void select_parachute_antenna(ActionContext& context);
void start_uhf(ActionContext& context);
void stop_uhf(ActionContext& context);
void close_recording(ActionContext& context);

// leaving the cruise stage
void vent_coolant(ActionContext& context);
void cut_cruise_cables(ActionContext& context);
void fire_cruise_stage_separation(ActionContext& context);
void enable_gnc(ActionContext& context);
void warm_thrusters(ActionContext& context);
void start_detumble(ActionContext& context);
void start_turn_to_entry(ActionContext& context);
void jettison_cruise_balance_1(ActionContext& context);
void jettison_cruise_balance_2(ActionContext& context);

// entry
void start_guidance_wait(ActionContext& context);
void start_entry_guidance(ActionContext& context);
void jettison_balance_1(ActionContext& context);
void jettison_balance_2(ActionContext& context);
void jettison_balance_3(ActionContext& context);
void arm_pyros(ActionContext& context);
void safe_pyros(ActionContext& context);

// parachute
void fire_parachute_mortar(ActionContext& context);
void disable_thrusters(ActionContext& context);
void enable_thrusters(ActionContext& context);
void fire_heatshield_separation(ActionContext& context);
void start_radar_processing(ActionContext& context);
void open_engine_valves(ActionContext& context);

// powered descent and sky crane
void fire_backshell_separation(ActionContext& context);
void ignite_engines(ActionContext& context);
void start_sky_crane(ActionContext& context);
void fire_rover_separation(ActionContext& context);
void release_bridle(ActionContext& context);
void enable_touchdown_logic(ActionContext& context);
void declare_touchdown(ActionContext& context);
void fire_bridle_cutters(ActionContext& context);
void start_flyaway(ActionContext& context);
void stop_engines(ActionContext& context);
}  // namespace actions

}  // namespace aeolis::flight
