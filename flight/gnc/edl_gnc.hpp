// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/gnc/attitude/attitude_control.hpp"
#include "flight/gnc/attitude/steering.hpp"
#include "flight/gnc/attitude/thruster_answer.hpp"
#include "flight/gnc/entry/lateral_logic.hpp"
#include "flight/gnc/entry/target_geometry.hpp"
#include "flight/gnc/navigation/dead_reckoning.hpp"
#include "flight/gnc/navigation/force_filter.hpp"
#include "flight/gnc/navigation/radar_batch.hpp"
#include "flight/gnc/navigation/radar_filter.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "flight/gnc/navigation/wind_estimate.hpp"
#include "flight/gnc/powered_descent/divert.hpp"
#include "flight/gnc/powered_descent/vertical_profile.hpp"
#include "flight/gnc/quantities.hpp"
#include "flight/gnc/sky_crane/rate_control.hpp"
#include "flight/gnc/sky_crane/touchdown_logic.hpp"
#include "flight/gnc/triggers/triggers.hpp"
#include "flight/load.hpp"
#include "generated/state_machines.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

// EdlGnc: the library that closes the loop from cruise-stage separation to touchdown.
// It has no thread; EdlMain runs it exactly once in each 64 Hz cycle, between two passes of the timeline. It uses the
// navigated state and never the truth. R17, R18, R27, R47
namespace aeolis::flight::gnc {

/// Ground's navigation solution and targets, from EDL_SET_PARAMETERS.
/// Position and velocity in M, relative to rotating Mars.
struct Solution {
    Sclk epoch;
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    Sclk entry;
    double target_latitude_rad = 0.0;   ///< areocentric
    double target_longitude_rad = 0.0;  ///< east
    double target_radius_m = 0.0;
    // NOLINTBEGIN(readability-magic-numbers): as EDL_SET_PARAMETERS has them until the first command
    double parachute_speed_mps = 405.0;
    double parachute_altitude_min_m = 6000.0;  ///< down to this altitude the parachute waits for its speed
    double heatshield_speed_mps = 142.0;
    double backshell_altitude_m = 1660.0;
    double backshell_descent_rate_mps = 79.1;  ///< to which the altitude belongs
    // NOLINTEND(readability-magic-numbers)

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(epoch, p_MoB_M_m, v_MB_M_mps, entry, target_latitude_rad, target_longitude_rad, target_radius_m,
                 parachute_speed_mps, parachute_altitude_min_m, heatshield_speed_mps, backshell_altitude_m,
                 backshell_descent_rate_mps);
    }
};

/// Change of the configuration by a device's action, known once its reply verifies it. R50
enum class Fact : std::uint8_t {
    none,
    pyros_armed,
    pyros_safe,
    cruise_stage_gone,
    parachute_out,
    heatshield_gone,
    engines_primed,
    backshell_gone,
    rover_separated,
    bridle_cut,
    thrusters_on,
};

/// Configuration that GNC must fly: the timeline's progress, read by GNC each cycle. R26, R50
/// A device's action counts from its reply on (Fact); an order to GNC counts from its timepoint on.
struct Configuration {
    bool enabled = false;  ///< "GNC enable" has fired
    bool pyros_armed = false;
    bool cruise_stage_gone = false;
    bool turning_to_entry = false;  ///< start_turn_to_entry has fired: trim attitude, bank held until guidance
    bool guidance_armed = false;    ///< entry guidance may start when drag is high enough
    bool sufr_allowed = false;
    bool parachute_out = false;  ///< mortar fired
    std::optional<Sclk> parachute_time;
    bool heatshield_gone = false;
    std::optional<Sclk> heatshield_time;
    std::optional<Sclk> thrusters_on_time;  ///< commanded on then, which was not refused, and not off since
    bool radar_on = false;
    bool engines_primed = false;
    bool backshell_gone = false;
    std::optional<Sclk> backshell_time;
    bool engines_ignited = false;    ///< order to GNC; the engines' reply tells whether they run
    bool sky_crane_started = false;  ///< throttle-down has fired: four engines
    bool rover_separated = false;
    std::optional<Sclk> rover_separation_time;
    bool touchdown_logic_ready = false;
    bool touchdown_declared = false;
    bool bridle_cut = false;
    bool flyaway_started = false;
    bool engines_off = false;  ///< order to GNC

    /// Records an action, commanded at `since`, that is done or assumed to be done. A repeated action keeps its first
    /// time.
    void learn(Fact fact, Sclk since);
    /// Takes back an action that was not done after all.
    void forget(Fact fact);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(enabled, pyros_armed, cruise_stage_gone, turning_to_entry, guidance_armed, sufr_allowed, parachute_out,
                 parachute_time, heatshield_gone, heatshield_time, thrusters_on_time, radar_on, engines_primed,
                 backshell_gone, backshell_time, engines_ignited, sky_crane_started, rover_separated,
                 rover_separation_time, touchdown_logic_ready, touchdown_declared, bridle_cut, flyaway_started,
                 engines_off);
    }
};

/// GNC's "now": the timeline fires the timepoint in the second pass of the same cycle. R17
enum class Trigger : std::uint8_t {
    guidance_start,
    heading_alignment,
    sufr_start,
    parachute,
    heatshield,
    radar_lock,
    engine_priming,
    backshell,
    powered_approach,
    constant_velocity,
    constant_deceleration,
    sky_crane,
    rover_separation,
    touchdown,
};
inline constexpr std::size_t trigger_count = static_cast<std::size_t>(Trigger::touchdown) + 1;

using Mode = GncMode;  ///< in the order in which they occur

/// A trigger with its own conditions: all hold when it has fired; some do not while it is held. R38
struct JudgedTrigger {
    Trigger trigger{};
    Conditions conditions;
};

/// A change of mode and its event in state_machines.csv. R38
struct ModeChange {
    Mode from{};
    GncModeEvent event{};
    Mode to{};
    std::optional<Condition> because;  ///< of an event that no trigger or timepoint explains
};

/// A bank reversal that begins. R38
struct BankReversal {
    std::uint8_t number = 0;  ///< 0: none
    Conditions conditions;
};

/// A radar solution that the gate refuses, or that is believed although it is beyond the gate. R38
struct RadarDecision {
    bool believed = false;
    Conditions conditions;
};

/// All outputs of GNC in one cycle.
struct Output {
    Mode mode = Mode::off;
    FixedVector<ModeChange, 4> mode_changes;  ///< in this cycle, in order
    FixedVector<JudgedTrigger, 4> triggers;   ///< fired in this cycle
    FixedVector<JudgedTrigger, 4> held;       ///< near, and not fired in this cycle
    BankReversal bank_reversal;               ///< began in this cycle
    AttitudeCommand attitude;                 ///< commanded by guidance
    ThrusterCommand thrusters;                ///< computed by attitude control
    EngineCommand engines;
    // Telemetry: the navigated state and guidance's commands. Frame M, SI, degrees where the name says so.
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    std::array<double, 4> q_MB{1, 0, 0, 0};  ///< navigated attitude, used by EdlBg for the radar's beams
    double altitude_m = 0.0;                 ///< above the target's radius, or above ground once the radar locked
    double speed_mps = 0.0;
    double descent_rate_mps = 0.0;
    double horizontal_speed_mps = 0.0;
    double flight_path_deg = 0.0;
    double bank_deg = 0.0;
    double angle_of_attack_deg = 0.0;
    double drag_mps2 = 0.0;
    Conditions sidestep;  ///< by which its side was chosen; empty but in the cycle of that
    double range_to_go_m = 0.0;
    double crossrange_m = 0.0;
    double predicted_range_m = 0.0;
    double bank_command_deg = 0.0;
    double lift_to_drag_command = 0.0;
    double dynamic_pressure_Pa = 0.0;
    double mach = 0.0;
    std::uint8_t reversals = 0;
    std::array<double, 3> acceleration_B_mps2{};
    std::array<double, 3> rate_B_rps{};
    double thrust_command_N = 0.0;
    double mass_kg = 0.0;
    double propellant_kg = 0.0;
    bool radar_locked = false;
    std::uint16_t radar_beams = 0;         ///< of the last radar solution
    bool imu_heard = true;                 ///< it measured in this cycle: force and rates above are not reckoned
    bool engines_heard = false;            ///< their controllers reported in this cycle
    double engines_silent_s = 0.0;         ///< they have not for so long, though the valves are open
    bool thrusters_judged = false;         ///< they are commanded on, and should obey
    std::optional<double> thrusters_felt;  ///< part of the pulses that the IMU feels, when it has just been judged
    double dead_reckoned_s = 0.0;          ///< the IMU has been silent for so long; 0 while it speaks
    double attitude_uncertainty_deg = 0.0, velocity_uncertainty_mps = 0.0, altitude_uncertainty_m = 0.0;
    bool propellant_low = false;  ///< before fly-away
};

/// Effectors that steer in a mode: the engines once guidance throttles them, otherwise the thrusters.
Steers steers(Mode mode, const Configuration& configuration, const EngineCommand& engines);
/// Inertia of the body that is steered: the vehicle, later the stage with or without the rover.
Inertia inertia_of(Mode mode, const Configuration& configuration, double rigid_kg);
/// What carries the vehicle in a mode, by which the force on it is estimated while the IMU is silent.
HeldBy held_by(Mode mode, const EngineCommand& engines);

/// The whole state of GNC, a value of fixed size.
class EdlGnc {
  public:
    explicit EdlGnc(const Load& load);

    /// Flies by `parameters` from the next cycle on.
    void set_parameters(const Parameters& parameters) { load_.parameters = parameters; }

    /// Takes ground's solution and (re)initialises navigation, propagated to `now` when the epoch is past.
    void set_solution(const Solution& solution, Sclk now);

    /// Attitude from cruise attitude determination, accepted until the cruise stage is gone.
    void on(const CruiseAttitude& attitude);

    /// Takes a radar solution, at 1 Hz. Returns the decision on it unless it is ordinary.
    std::optional<RadarDecision> on(const RadarSolution& solution);

    /// Runs GNC; call exactly once in each 64 Hz cycle.
    void cycle(const DeviceInputs& in, const Configuration& configuration, Output& out);

    /// Shifts the navigated state from outside (a case of a campaign).
    void shift_navigation(const NavigationShift& by) { strapdown_.shift(by); }

    /// Runs navigation alone, over a cycle that another computer may have missed.
    void catch_up(std::span<const ImuSample> imu, Sclk now) { navigate(imu, now); }

    /// State that another computer needs to continue; without the parameters and the radar filter's history.
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(solution_, target_M_, navigating_, navigated_to_, pulses_felt_until_, strapdown_, reckoning_, belief_,
                 smooth_force_B_mps2_, force_filter_, radar_filter_, wind_, measured_.altitude_m, mode_machine_,
                 mode_since_, fired_, due_for_parachute_, low_for_backshell_, radar_first_, lateral_, bank_command_rad_,
                 bank_at_sufr_rad_, bank_allowed_rad_, predicted_range_m_, lift_to_drag_command_, mass_kg_,
                 thrust_command_N_, approach_, divert_, divert_from_M_, deceleration_, rate_control_, touchdown_logic_,
                 last_radar_beams_, last_radar_altitude_m_, engines_silent_s_);
    }

    Mode mode() const { return mode_machine_.state(); }
    bool navigating() const { return navigating_; }

  private:
    /// Quantities derived once per cycle from the navigated state.
    struct Measured {
        Vector3 up_M = Vector3::UnitX();
        Vector3 free_M_mps2 = Vector3::Zero();  ///< acceleration in free fall
        Vector3 level_velocity_M = Vector3::Zero();
        double altitude_m = 0.0;
        double speed_mps = 0.0;
        double descent_rate_mps = 0.0;
        double deceleration_mps2 = 0.0;  ///< of the planet-relative speed
        double dynamic_pressure_Pa = 0.0, mach = 0.0;
        double bank_rad = 0.0;
        TargetGeometry target;
    };

    void navigate(std::span<const ImuSample> imu, Sclk now);
    void reckon(double passed_s);
    void take_cruise_attitude();
    void level_by(const RadarCorrection& correction);
    void measure(Sclk now);
    void feel_wind();
    bool take(GncModeEvent event, Sclk now, Output& out, const std::optional<Condition>& because = {});
    bool fire(Trigger trigger, const Conditions& conditions, Output& out);
    void hold(Trigger trigger, const Conditions& conditions, Output& out) const;
    bool fired(Trigger trigger) const { return fired_[static_cast<std::size_t>(trigger)]; }
    void follow_configuration(const Configuration& configuration, Sclk now, Output& out);
    void decide_in_air(const Configuration& configuration, Sclk now, Output& out);
    void decide_on_engines(const Configuration& configuration, Sclk now, Output& out);
    void guide_entry(Sclk now, const Configuration& configuration, Output& out);
    void guide_descent(Sclk now, const Configuration& configuration, Output& out);
    void push(const Vector3& acceleration_M, int engines, Output& out);
    void steer(const Configuration& configuration, Output& out);
    void burn(const DeviceInputs& in, const Configuration& configuration);
    void watch_devices(const DeviceInputs& in, const Configuration& configuration, Output& out);
    void report(Output& out) const;
    double since(Sclk then) const { return measured_at_ - then; }
    const Parameters& parameters() const { return load_.parameters; }

    Load load_;
    Solution solution_;
    Vector3 target_M_ = Vector3::UnitX();
    bool navigating_ = false;
    std::optional<CruiseAttitude> cruise_attitude_;  ///< taken when the increments have reached its tick
    bool cruise_stage_gone_ = false;
    Sclk navigated_to_;
    Sclk pulses_felt_until_;  ///< in vacuum: until then thruster pulses are felt
    Strapdown strapdown_;
    DeadReckoning reckoning_;
    Belief belief_;
    Surroundings surroundings_;  ///< as of the last cycle
    Vector3 smooth_force_B_mps2_ = Vector3::Zero();
    ForceFilter force_filter_;
    RadarFilter radar_filter_;
    WindEstimate wind_;
    Measured measured_;
    Sclk measured_at_;

    GncModeMachine mode_machine_;
    Sclk mode_since_;
    std::array<bool, trigger_count> fired_{};
    triggers::Persistence due_for_parachute_, low_for_backshell_;
    bool radar_first_ = false;  ///< a radar solution has been accepted

    LateralLogic lateral_;
    double bank_command_rad_ = 0.0;
    double bank_at_sufr_rad_ = 0.0;
    double bank_allowed_rad_ = pi;  ///< by the height guard
    double predicted_range_m_ = 0.0;
    double lift_to_drag_command_ = 0.0;

    double mass_kg_ = 0.0;  ///< estimate, while on engines
    double thrust_command_N_ = 0.0;
    double thrust_felt_N_ = 0.0;  ///< as engines told last; what was asked for until they do
    double engines_silent_s_ = 0.0;
    Steering steering_;
    ThrusterAnswer thruster_answer_;
    powered_descent::ApproachProfile approach_;
    powered_descent::Divert divert_;
    Vector3 divert_from_M_ = Vector3::Zero();
    powered_descent::DecelerationProfile deceleration_;
    sky_crane::RateControl rate_control_;
    sky_crane::TouchdownLogic touchdown_logic_;
    std::uint16_t last_radar_beams_ = 0;
    double last_radar_altitude_m_ = 0.0;
};
static_assert(std::is_trivially_destructible_v<EdlGnc>);  // copying it is a snapshot

}  // namespace aeolis::flight::gnc
