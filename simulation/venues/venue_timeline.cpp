// SPDX-License-Identifier: Apache-2.0
#include "simulation/venues/venue_timeline.hpp"

namespace aeolis::simulation {
namespace {

using flight::PyroId;
using flight::gnc::Trigger;

/// The objects that a row may change.
struct Touched {
    Sclk now;
    flight::gnc::Configuration& configuration;
    flight::DeviceOutputs& out;
};

struct Row {
    std::string_view timepoint;    ///< the timepoint that it replaces
    std::optional<Trigger> after;  ///< none: entry
    double offset_s;
    void (*action)(Touched&);
};

template <PyroId pyro>
void fire(Touched& t) {
    t.out.pyros.push_back({pyro, flight::Unit::a});
}

constexpr std::array rows{
    Row{"cruise_cables_cut", {}, -608.0, fire<PyroId::cruise_cable_cutter>},
    Row{"cruise_stage_separation",
        {},
        -600.046875,
        [](Touched& t) {
            fire<PyroId::cruise_stage_separation>(t);
            t.configuration.cruise_stage_gone = true;
        }},
    Row{"gnc_enable", {}, -540.0, [](Touched& t) { t.configuration.enabled = true; }},
    Row{"detumble", {}, -519.40625, [](Touched& t) { t.out.thrusters_enabled = true; }},
    Row{"turn_to_entry", {}, -505.0, [](Touched& t) { t.configuration.turning_to_entry = true; }},
    Row{"cruise_balance_1", {}, -489.0, fire<PyroId::cruise_balance_1>},
    Row{"cruise_balance_2", {}, -488.0, fire<PyroId::cruise_balance_2>},
    Row{"wait_for_guidance", {}, -300.0, [](Touched& t) { t.configuration.guidance_armed = true; }},
    Row{"entry_guidance", Trigger::guidance_start, 0.0, [](Touched& t) { t.configuration.sufr_allowed = true; }},
    Row{"balance_1", Trigger::sufr_start, 0.0, fire<PyroId::entry_balance_1>},
    Row{"balance_2", Trigger::sufr_start, 2.0, fire<PyroId::entry_balance_2>},
    Row{"balance_3", Trigger::sufr_start, 4.0, fire<PyroId::entry_balance_3>},
    Row{"parachute_deploy", Trigger::parachute, 0.0,
        [](Touched& t) {
            fire<PyroId::parachute_mortar>(t);
            t.configuration.parachute_out = true;
            t.configuration.parachute_time = t.now;
            t.out.thrusters_enabled = false;
        }},
    Row{"radar_power", Trigger::parachute, 6.0,
        [](Touched& t) { t.out.switches.push_back({flight::SwitchId::radar, true}); }},
    Row{"heatshield_separation", Trigger::heatshield, 0.0,
        [](Touched& t) {
            fire<PyroId::heatshield_separation>(t);
            t.configuration.heatshield_gone = true;
            t.configuration.heatshield_time = t.now;
        }},
    Row{"thrusters_on", Trigger::heatshield, 0.296875, [](Touched& t) { t.out.thrusters_enabled = true; }},
    Row{"radar_processing", Trigger::heatshield, 2.0, [](Touched& t) { t.configuration.radar_on = true; }},
    Row{"engine_priming", Trigger::engine_priming, 0.0,
        [](Touched& t) {
            fire<PyroId::engine_valves>(t);
            t.configuration.engines_primed = true;
        }},
    Row{"backshell_separation", Trigger::backshell, 0.0,
        [](Touched& t) {
            fire<PyroId::backshell_separation>(t);
            t.configuration.backshell_gone = true;
            t.configuration.backshell_time = t.now;
        }},
    Row{"engine_ignition", Trigger::backshell, 1.0, [](Touched& t) { t.configuration.engines_ignited = true; }},
    Row{"sky_crane", Trigger::sky_crane, 0.0, [](Touched& t) { t.configuration.sky_crane_started = true; }},
    Row{"rover_separation", Trigger::rover_separation, 0.0,
        [](Touched& t) {
            fire<PyroId::rover_separation>(t);
            t.configuration.rover_separated = true;
            t.configuration.rover_separation_time = t.now;
            t.out.pay_out_bridle = true;
        }},
    Row{"touchdown_logic", Trigger::rover_separation, 8.90625,
        [](Touched& t) { t.configuration.touchdown_logic_ready = true; }},
    Row{"touchdown", Trigger::touchdown, 0.0, [](Touched& t) { t.configuration.touchdown_declared = true; }},
    Row{"bridle_cut", Trigger::touchdown, 0.59375,
        [](Touched& t) {
            fire<PyroId::bridle_cutter>(t);
            t.configuration.bridle_cut = true;
        }},
    Row{"flyaway", Trigger::touchdown, 0.703125, [](Touched& t) { t.configuration.flyaway_started = true; }},
    Row{"engines_off", Trigger::touchdown, 7.296875, [](Touched& t) { t.configuration.engines_off = true; }},
};

}  // namespace

VenueTimeline::VenueTimeline(Sclk entry) : entry_(entry) {
    static_assert(rows.size() <= rows_max);
}

std::vector<VenueTimeline::Line> VenueTimeline::lines() {
    std::vector<Line> all;
    all.reserve(rows.size());
    for (const Row& row : rows) all.push_back({row.timepoint, row.after, row.offset_s});
    return all;
}

void VenueTimeline::act(Sclk now, flight::DeviceOutputs& out) {
    Touched touched{now, configuration_, out};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (done_[i]) continue;
        const auto& start = rows[i].after ? triggered_[static_cast<std::size_t>(*rows[i].after)] : entry_;
        // No row waits for the one before it.
        const timeline::Offsets offsets{.anchor = AnchorId{}, .desired_s = rows[i].offset_s, .minimum_s = {}};
        if (!(now >= timeline::due_times(offsets, {}, start).desired)) continue;
        done_[i] = true;
        rows[i].action(touched);
    }
}

void VenueTimeline::take(const flight::gnc::Output& told, Sclk now) {
    for (const auto& one : told.triggers) triggered_[static_cast<std::size_t>(one.trigger)] = now;
}

}  // namespace aeolis::simulation
