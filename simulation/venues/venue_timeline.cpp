#include "simulation/venues/venue_timeline.hpp"

#include <span>

namespace aeolis::simulation {
namespace {

using flight::PyroId;
using flight::gnc::Trigger;

/// What a row may touch.
struct Touched {
    Sclk now;
    flight::gnc::Configuration& configuration;
    flight::DeviceOutputs& out;
};

struct Row {
    std::optional<Trigger> after; ///< none: entry
    double offset_s;
    void (*action)(Touched&);
};

template <PyroId pyro>
void fire(Touched& t) {
    t.out.pyros.push_back(pyro);
}

constexpr std::array rows{
    Row{{}, -640.0, [](Touched& t) { t.out.switches.push_back({flight::SwitchId::descent_imu, true}); }},
    Row{{}, -608.0, fire<PyroId::cruise_cable_cutter>},
    Row{{}, -600.046875,
        [](Touched& t) {
            fire<PyroId::cruise_stage_separation>(t);
            t.configuration.cruise_stage_gone = true;
        }},
    Row{{}, -540.0, [](Touched& t) { t.configuration.enabled = true; }},
    Row{{}, -519.40625, [](Touched& t) { t.out.thrusters_enabled = true; }},
    Row{{}, -505.0, [](Touched& t) { t.configuration.turning_to_entry = true; }},
    Row{{}, -489.0, fire<PyroId::cruise_balance_1>},
    Row{{}, -488.0, fire<PyroId::cruise_balance_2>},
    Row{{}, -300.0, [](Touched& t) { t.configuration.guidance_armed = t.configuration.sufr_allowed = true; }},
    Row{Trigger::sufr_start, 0.0, fire<PyroId::entry_balance_1>},
    Row{Trigger::sufr_start, 2.0, fire<PyroId::entry_balance_2>},
    Row{Trigger::sufr_start, 4.0, fire<PyroId::entry_balance_3>},
    Row{Trigger::parachute, 0.0,
        [](Touched& t) {
            fire<PyroId::parachute_mortar>(t);
            t.configuration.parachute_out = true;
            t.configuration.parachute_time = t.now;
            t.out.thrusters_enabled = false;
        }},
    Row{Trigger::parachute, 6.0, [](Touched& t) { t.out.switches.push_back({flight::SwitchId::radar, true}); }},
    Row{Trigger::heatshield, 0.0,
        [](Touched& t) {
            fire<PyroId::heatshield_separation>(t);
            t.configuration.heatshield_gone = true;
            t.configuration.heatshield_time = t.now;
        }},
    Row{Trigger::heatshield, 0.296875, [](Touched& t) { t.out.thrusters_enabled = true; }},
    Row{Trigger::heatshield, 2.0, [](Touched& t) { t.configuration.radar_on = true; }},
    Row{Trigger::engine_priming, 0.0,
        [](Touched& t) {
            fire<PyroId::engine_valves>(t);
            t.configuration.engines_primed = true;
        }},
    Row{Trigger::backshell, 0.0,
        [](Touched& t) {
            fire<PyroId::backshell_separation>(t);
            t.configuration.backshell_gone = true;
            t.configuration.backshell_time = t.now;
        }},
    Row{Trigger::backshell, 1.0, [](Touched& t) { t.configuration.engines_ignited = true; }},
    Row{Trigger::sky_crane, 0.0, [](Touched& t) { t.configuration.sky_crane_started = true; }},
    Row{Trigger::rover_separation, 0.0,
        [](Touched& t) {
            fire<PyroId::rover_separation>(t);
            t.configuration.rover_separated = true;
            t.configuration.rover_separation_time = t.now;
            t.out.pay_out_bridle = true;
        }},
    Row{Trigger::rover_separation, 8.90625, [](Touched& t) { t.configuration.touchdown_logic_ready = true; }},
    Row{Trigger::touchdown, 0.0, [](Touched& t) { t.configuration.touchdown_declared = true; }},
    Row{Trigger::touchdown, 0.59375,
        [](Touched& t) {
            fire<PyroId::bridle_cutter>(t);
            t.configuration.bridle_cut = true;
        }},
    Row{Trigger::touchdown, 0.703125, [](Touched& t) { t.configuration.flyaway_started = true; }},
    Row{Trigger::touchdown, 7.296875, [](Touched& t) { t.configuration.engines_off = true; }},
};

} // namespace

VenueTimeline::VenueTimeline(Sclk entry) : entry_(entry) {
    static_assert(rows.size() <= rows_max);
}

void VenueTimeline::act(Sclk now, flight::DeviceOutputs& out) {
    Touched touched{now, configuration_, out};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& start = rows[i].after ? triggered_[static_cast<std::size_t>(*rows[i].after)] : entry_;
        if (done_[i] || !start || now < *start + rows[i].offset_s) continue;
        done_[i] = true;
        rows[i].action(touched);
    }
}

void VenueTimeline::take(const flight::gnc::Output& told, Sclk now) {
    for (const Trigger trigger : told.triggers)
        triggered_[static_cast<std::size_t>(trigger)] = now;
}

} // namespace aeolis::simulation
