#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/load.hpp"

#include <array>
#include <cstdint>
#include <optional>

// EdlGnc: the library that closes the loop from cruise-stage separation to touchdown. It has no thread; EdlMain runs it
// exactly once in each 64 Hz cycle, between two passes of the timeline. It works from the navigated state and never
// sees the truth. R17, R18, R27, R47
namespace aeolis::flight::gnc {

/// What ground knows best, from EDL_SET_PARAMETERS. Position and velocity in M, relative to rotating Mars.
struct Solution {
    Sclk epoch;
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    Sclk entry;
    double target_latitude_rad = 0.0;  ///< areocentric
    double target_longitude_rad = 0.0; ///< east
    double target_radius_m = 0.0;
    double parachute_speed_mps = 405.0;
    double heatshield_speed_mps = 142.0;
    double backshell_altitude_m = 1660.0;
};

/// What the timeline has done, as GNC asks for it each cycle: the configuration that GNC must fly. R26
struct Configuration {
    bool enabled = false;              ///< GNC enable has fired
    bool cruise_stage_gone = false;
    bool turning_to_entry = false;     ///< start_turn_to_entry has fired: trim attitude, bank held until guidance
    bool guidance_armed = false;       ///< may start entry guidance when drag says so
    bool sufr_allowed = false;
    bool parachute_out = false;        ///< mortar fired
    std::optional<Sclk> parachute_time;
    bool heatshield_gone = false;
    std::optional<Sclk> heatshield_time;
    bool radar_on = false;
    bool engines_primed = false;
    bool backshell_gone = false;
    std::optional<Sclk> backshell_time;
    bool engines_ignited = false;
    bool sky_crane_started = false;    ///< throttle-down has fired: four engines
    bool rover_separated = false;
    std::optional<Sclk> rover_separation_time;
    bool touchdown_logic_ready = false;
    bool touchdown_declared = false;
    bool bridle_cut = false;
    bool flyaway_started = false;
    bool engines_off = false;
};

/// Averages that EdlBg made of the radar's beams over 5 s, sent to the filter at 1 Hz. Made by
/// navigation/radar_batch.hpp; the filter averages its own past over the same span, so the delay does no harm. R25
struct RadarSolution {
    Sclk time;                             ///< middle of the measurements averaged
    double span_s = 0.0;                   ///< from the first measurement averaged to the last
    double altitude_m = 0.0;               ///< above the ground below
    std::array<double, 3> v_MB_M_mps{};
    std::uint16_t beams = 0;
};

/// "Now": GNC starts these; the timeline fires the timepoint in the second pass of the same cycle. R17
enum class Trigger : std::uint8_t {
    guidance_start, heading_alignment, sufr_start, parachute, heatshield, radar_lock, engine_priming, backshell,
    powered_approach, constant_velocity, constant_deceleration, sky_crane, rover_separation, touchdown,
};
inline constexpr std::size_t trigger_count = 14;

enum class Mode : std::uint8_t {
    off, approach, wait_for_guidance_start, range_control, heading_alignment, straighten_up, wait_for_parachute,
    parachute_descent, free_fall, powered_approach, constant_velocity, constant_deceleration, sky_crane, touchdown,
    flyaway,
};

/// One condition behind a decision, for its explanation. R38
struct Condition {
    std::uint16_t quantity = 0;   ///< index in the dictionary's enumeration of quantities (see edl_gnc.cpp)
    double value = 0.0;
    double bound = 0.0;
    enum class Comparison : std::uint8_t { lt, le, eq, ge, gt } comparison{};
    bool holds = false;
};

/// Everything that GNC tells the rest in one cycle.
struct Output {
    Mode mode = Mode::off;
    FixedVector<Trigger, 4> triggers;          ///< fired in this cycle
    FixedVector<Condition, 4> conditions;      ///< of the last trigger in `triggers`
    std::uint8_t bank_reversal = 0;            ///< number of the reversal that began in this cycle, 0: none
    AttitudeCommand attitude;
    EngineCommand engines;
    // Telemetry: the navigated state and what guidance wants. Frame M, SI, degrees where the name says so.
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    std::array<double, 4> q_MB{1, 0, 0, 0};    ///< navigated attitude, what EdlBg needs to use the radar's beams
    double altitude_m = 0.0;                   ///< above the target's radius, or above ground once the radar locked
    double speed_mps = 0.0;
    double descent_rate_mps = 0.0;
    double horizontal_speed_mps = 0.0;
    double flight_path_deg = 0.0;
    double bank_deg = 0.0;
    double angle_of_attack_deg = 0.0;
    double drag_mps2 = 0.0;
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
};

/// All of GNC's state, a value of fixed size.
class EdlGnc {
  public:
    explicit EdlGnc(const Load& load);

    /// Ground's solution, or a newer one: (re)initialises navigation, propagated to `now` when the epoch has passed.
    void set_solution(const Solution& solution, Sclk now);

    /// Attitude from cruise attitude determination, accepted until the cruise stage is gone.
    void on(const CruiseAttitude& attitude);

    /// One radar solution, at 1 Hz.
    void on(const RadarSolution& solution);

    /// Exactly once in each 64 Hz cycle.
    void cycle(const DeviceInputs& in, const Configuration& configuration, Output& out);

  private:
    struct State;
    // The gnc engineer defines the members here: fixed-size Eigen is allowed, the heap is not.
};

}  // namespace aeolis::flight::gnc
