#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/gnc/navigation/radar_batch.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/world.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

// The venue "GNC alone": the simulated world flown by EdlGnc, with a few lines in place of the timeline. What is
// commanded when is [facts] Timeline; nothing of executive, telemetry or radio takes part.
namespace aeolis::tests {

inline flight::Load load_of(const simulation::Scenario& scenario) {
    flight::Load load;
    load.entry_mass_kg = scenario.masses.entry_kg;
    load.powered_descent_mass_kg = scenario.masses.powered_descent_kg;
    load.descent_stage_dry_kg =
        scenario.masses.powered_descent_kg - scenario.masses.rover_kg - scenario.masses.propellant_kg;
    load.rover_mass_kg = scenario.masses.rover_kg;
    load.entry_reference = simulation::make_entry_reference(scenario);
    return load;
}

/// What the venue's timeline may touch.
struct VenueCommands {
    Sclk now;
    flight::gnc::Configuration configuration;
    flight::DeviceOutputs out;
};

enum VenueAnchor : std::size_t {
    entry,
    sufr,
    parachute,
    heatshield,
    priming,
    backshell,
    sky_crane,
    rover,
    touchdown,
    anchor_count,
};

struct VenueRow {
    VenueAnchor anchor;
    double offset_s;
    void (*action)(VenueCommands&);
};

template <flight::PyroId pyro>
void fire(VenueCommands& v) {
    v.out.pyros.push_back(pyro);
}

inline constexpr std::array venue_timeline{
    VenueRow{entry, -640.0,
             [](VenueCommands& v) {
                 v.out.switches.push_back({flight::SwitchId::descent_imu, true});
             }},
    VenueRow{entry, -608.0, fire<flight::PyroId::cruise_cable_cutter>},
    VenueRow{entry, -600.046875,
             [](VenueCommands& v) {
                 fire<flight::PyroId::cruise_stage_separation>(v);
                 v.configuration.cruise_stage_gone = true;
             }},
    VenueRow{entry, -540.0, [](VenueCommands& v) { v.configuration.enabled = true; }},
    VenueRow{entry, -519.40625, [](VenueCommands& v) { v.out.thrusters_enabled = true; }},
    VenueRow{entry, -505.0, [](VenueCommands& v) { v.configuration.turning_to_entry = true; }},
    VenueRow{entry, -489.0, fire<flight::PyroId::cruise_balance_1>},
    VenueRow{entry, -488.0, fire<flight::PyroId::cruise_balance_2>},
    VenueRow{entry, -300.0,
             [](VenueCommands& v) { v.configuration.guidance_armed = v.configuration.sufr_allowed = true; }},
    VenueRow{sufr, 0.0, fire<flight::PyroId::entry_balance_1>},
    VenueRow{sufr, 2.0, fire<flight::PyroId::entry_balance_2>},
    VenueRow{sufr, 4.0, fire<flight::PyroId::entry_balance_3>},
    VenueRow{parachute, 0.0,
             [](VenueCommands& v) {
                 fire<flight::PyroId::parachute_mortar>(v);
                 v.configuration.parachute_out = true;
                 v.configuration.parachute_time = v.now;
                 v.out.thrusters_enabled = false;
             }},
    VenueRow{parachute, 6.0,
             [](VenueCommands& v) {
                 v.out.switches.push_back({flight::SwitchId::radar, true});
             }},
    VenueRow{heatshield, 0.0,
             [](VenueCommands& v) {
                 fire<flight::PyroId::heatshield_separation>(v);
                 v.configuration.heatshield_gone = true;
                 v.configuration.heatshield_time = v.now;
             }},
    VenueRow{heatshield, 0.296875, [](VenueCommands& v) { v.out.thrusters_enabled = true; }},
    VenueRow{heatshield, 2.0, [](VenueCommands& v) { v.configuration.radar_on = true; }},
    VenueRow{priming, 0.0,
             [](VenueCommands& v) {
                 fire<flight::PyroId::engine_valves>(v);
                 v.configuration.engines_primed = true;
             }},
    VenueRow{backshell, 0.0,
             [](VenueCommands& v) {
                 fire<flight::PyroId::backshell_separation>(v);
                 v.configuration.backshell_gone = true;
                 v.configuration.backshell_time = v.now;
             }},
    VenueRow{backshell, 1.0, [](VenueCommands& v) { v.configuration.engines_ignited = true; }},
    VenueRow{sky_crane, 0.0, [](VenueCommands& v) { v.configuration.sky_crane_started = true; }},
    VenueRow{rover, 0.0,
             [](VenueCommands& v) {
                 fire<flight::PyroId::rover_separation>(v);
                 v.configuration.rover_separated = true;
                 v.configuration.rover_separation_time = v.now;
                 v.out.pay_out_bridle = true;
             }},
    VenueRow{rover, 8.90625, [](VenueCommands& v) { v.configuration.touchdown_logic_ready = true; }},
    VenueRow{touchdown, 0.0, [](VenueCommands& v) { v.configuration.touchdown_declared = true; }},
    VenueRow{touchdown, 0.59375,
             [](VenueCommands& v) {
                 fire<flight::PyroId::bridle_cutter>(v);
                 v.configuration.bridle_cut = true;
             }},
    VenueRow{touchdown, 0.703125, [](VenueCommands& v) { v.configuration.flyaway_started = true; }},
    VenueRow{touchdown, 7.296875, [](VenueCommands& v) { v.configuration.engines_off = true; }},
};

class GncVenue {
  public:
    /// A trigger of GNC, or a reversal, with what GNC and the truth said at that moment.
    struct Event {
        std::optional<flight::gnc::Trigger> trigger;
        std::uint8_t reversal = 0;
        flight::gnc::Output told;
        simulation::TruthState truth;
        simulation::World::Inspection seen;
    };

    GncVenue(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0)
        : world_(scenario, seed, case_number), gnc_(load_of(scenario)) {
        const simulation::NavigationSolution& from = world_.solution();
        flight::gnc::Solution solution;
        solution.epoch = from.epoch;
        solution.p_MoB_M_m = from.p_MoB_M_m;
        solution.v_MB_M_mps = from.v_MB_M_mps;
        solution.entry = from.entry;
        solution.target_latitude_rad = from.target.latitude_deg * flight::gnc::degree;
        solution.target_longitude_rad = from.target.longitude_deg * flight::gnc::degree;
        solution.target_radius_m = from.target.radius_m;
        solution.parachute_speed_mps = from.parachute_speed_mps;
        solution.heatshield_speed_mps = from.heatshield_speed_mps;
        solution.backshell_altitude_m = from.backshell_altitude_m;
        gnc_.set_solution(solution, world_.sclk());
        anchors_[entry] = from.entry;
    }

    bool running() const { return world_.outcome() == simulation::Outcome::running; }

    void step() {
        inputs_ = world_.sense();
        const flight::DeviceInputs& in = inputs_;
        commands_.out.begin_cycle();
        commands_.now = in.now;
        act();
        gnc_.cycle(in, commands_.configuration, told_);
        if (commands_.configuration.radar_on) {
            // As in flight: the beams meet the attitude of their own tick, and the solution waits for the next cycle.
            batch_.on(in.now, in.radar.span(), flight::gnc::to_quaternion(told_.q_MB),
                      flight::gnc::to_vector(told_.p_MoB_M_m).normalized());
            if (in.now.ticks() % 64 == 0)
                if (const auto solution = batch_.solve(in.now)) gnc_.on(*solution);
        }
        note();
        act();
        commands_.out.attitude = told_.attitude;
        commands_.out.engines = told_.engines;
        world_.advance(commands_.out);
    }

    void run() {
        while (running())
            step();
    }

    const simulation::World& world() const { return world_; }
    const flight::gnc::EdlGnc& gnc() const { return gnc_; }
    const flight::gnc::Output& told() const { return told_; }
    const flight::gnc::Configuration& configuration() const { return commands_.configuration; }
    const flight::DeviceInputs& last_inputs() const { return inputs_; }
    const std::vector<Event>& events() const { return events_; }
    const Event* event(flight::gnc::Trigger trigger) const {
        for (const Event& event : events_)
            if (event.trigger == trigger) return &event;
        return nullptr;
    }

  private:
    void act() {
        for (std::size_t i = 0; i < venue_timeline.size(); ++i) {
            const std::optional<Sclk>& anchor = anchors_[venue_timeline[i].anchor];
            if (done_[i] || !anchor || commands_.now < *anchor + venue_timeline[i].offset_s) continue;
            done_[i] = true;
            venue_timeline[i].action(commands_);
        }
    }

    void note() {
        using flight::gnc::Trigger;
        for (const Trigger trigger : told_.triggers) {
            events_.push_back({trigger, 0, told_, world_.truth(), world_.inspect()});
            switch (trigger) {
            case Trigger::sufr_start:
                anchors_[sufr] = commands_.now;
                break;
            case Trigger::parachute:
                anchors_[parachute] = commands_.now;
                break;
            case Trigger::heatshield:
                anchors_[heatshield] = commands_.now;
                break;
            case Trigger::engine_priming:
                anchors_[priming] = commands_.now;
                break;
            case Trigger::backshell:
                anchors_[backshell] = commands_.now;
                break;
            case Trigger::sky_crane:
                anchors_[sky_crane] = commands_.now;
                break;
            case Trigger::rover_separation:
                anchors_[rover] = commands_.now;
                break;
            case Trigger::touchdown:
                anchors_[touchdown] = commands_.now;
                break;
            default:
                break;
            }
        }
        if (told_.bank_reversal != 0)
            events_.push_back({std::nullopt, told_.bank_reversal, told_, world_.truth(), world_.inspect()});
    }

    simulation::World world_;
    flight::gnc::EdlGnc gnc_;
    flight::gnc::RadarBatch batch_;
    flight::DeviceInputs inputs_;
    VenueCommands commands_;
    flight::gnc::Output told_;
    std::array<std::optional<Sclk>, anchor_count> anchors_{};
    std::array<bool, venue_timeline.size()> done_{};
    std::vector<Event> events_;
};

} // namespace aeolis::tests
