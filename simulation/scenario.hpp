// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/devices/effectors.hpp"
#include "flight/load.hpp"
#include "simulation/mars/height_grid.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

// The definition of one landing. The server fills it from a text file and checks it with `impossible_values`.
namespace aeolis::simulation {

/// The true state at entry interface, relative to rotating Mars; the start is propagated back from it. [facts]
struct EntryState {
    double radius_m = 3522200.0;
    double latitude_deg = -3.9226;   ///< areocentric
    double longitude_deg = 126.703;  ///< east
    double speed_mps = 5845.2;       ///< planet-relative
    double flight_path_deg = -16.14;
    double azimuth_deg = 93.35;  ///< of the velocity, from north to east
};

struct Target {
    double latitude_deg = -4.6019;
    double longitude_deg = 137.4102;
    double radius_m = 3391148.0;
    /// Full axes of the ellipse about the target that should hold 99 % of the landings, the longer one along the
    /// course. They are a mission's goal, so there are none (0) unless the scenario sets them.
    double ellipse_major_m = 0.0, ellipse_minor_m = 0.0;
};

struct Masses {
    double cruise_stage_kg = 539.0;
    double cruise_balance_each_kg = 75.0;  ///< two
    double entry_kg = 3153.0;
    double entry_balance_each_kg = 25.0;  ///< six
    double heatshield_kg = 385.0;
    double backshell_and_parachute_kg = 349.0;
    double powered_descent_kg = 2269.0;
    double propellant_kg = 387.0;  ///< of the powered descent mass
    double rover_kg = 899.0;
};

/// Radii of gyration by the attached parts: about z, and about any axis across it. Flight's values are in
/// flight/devices/effectors.hpp; a scenario may differ, which is then a modelling error in flight.
struct Gyration {
    double with_cruise_stage_across_m = flight::gyration_with_cruise_stage.across_m;
    double with_cruise_stage_along_m = flight::gyration_with_cruise_stage.along_z_m;
    double entry_vehicle_across_m = flight::gyration_of_entry_vehicle.across_m;
    double entry_vehicle_along_m = flight::gyration_of_entry_vehicle.along_z_m;
    double without_heatshield_across_m = flight::gyration_without_heatshield.across_m;
    double without_heatshield_along_m = flight::gyration_without_heatshield.along_z_m;
    double stage_with_rover_across_m = flight::gyration_of_stage_with_rover.across_m;
    double stage_with_rover_along_m = flight::gyration_of_stage_with_rover.along_z_m;
    double stage_across_m = flight::gyration_of_stage.across_m;
    double stage_along_m = flight::gyration_of_stage.along_z_m;
};

/// Stations of the parts' centres of mass along z, from the descent stage's.
///
/// The balance masses' distance from the axis gives the entry vehicle's offset of 0.1 m [facts] (L). Not published: all
/// are our assumptions.
struct Stations {
    double rover_m = 0.4;
    double heatshield_m = 1.0;
    double backshell_m = -1.1;
    double cruise_stage_m = -1.6;
    double balances_m = 0.5;
    double balances_off_axis_m = 2.1;
};

/// One standard deviation of each seeded error; 0 switches it off.
struct Dispersions {
    double delivery_flight_path_deg = 0.0167;
    double delivery_position_m = 900.0;
    double knowledge_position_m = 930.0;  ///< ground's solution less the truth
    double knowledge_velocity_mps = 0.67;
    double density_fraction = 0.04;
    double drag_fraction = 0.01;
    double parachute_drag_fraction = 0.033;
    double wind_mps = 6.0;
    double imu_bias_mps2 = 3.3e-4;
    double gyro_bias_rps = 8.0e-8;
    double attitude_rad = 1.5e-3;
    double radar_range_fraction = 0.0067;
    double radar_velocity_mps = 0.033;
    double imu_misalignment_rad = 1.0e-4;  ///< of the sensors' axes, about each axis of B. Our assumption
    double gust_mps = 2.0;                 ///< of each horizontal component of gusts near the ground. Our assumption
    double radar_dropout_fraction = 0.01;  ///< not a deviation: the part of readings that fail. Our assumption
    double terrain_height_m = 0.0;
    double terrain_slope_deg = 0.0;       ///< of the slope towards east and towards north
    double parachute_plane_deg = 30.0;    ///< of the plane of the parachute's first lift, from up. Our assumption
    double mass_fraction = 0.001;         ///< of all parts alike
    double slow_drag_fraction = 0.033;    ///< of drag and lift at low Mach numbers; drag_fraction is for high ones
    double imu_scale_fraction = 1.0e-4;   ///< of each accelerometer. Our assumption
    double gyro_scale_fraction = 1.0e-5;  ///< of each gyro. Our assumption
    double imu_noise_mps = 5.0e-5;        ///< of each accelerometer, a reading. Our assumption
    double gyro_noise_rad = 2.0e-6;       ///< of each gyro, a reading. Our assumption
    double density_aloft_fraction = 0.0;  ///< of density from 65 km up, growing evenly from 50 km; 0: as below
    double parachute_oscillation_fraction = 0.0;  ///< of the swing of the parachute's area above Mach 1.4
    double radar_sand_mps = 0.0;                  ///< of velocity readings that moving sand spoils on the sky crane
    double terrain_roughness_m = 0.0;             ///< of the ground's heights at the nodes of its roughness
};

/// The ground around the target, over the sphere of its radius. A case adds its own (Dispersions). Our assumption.
struct Ground {
    double height_m = 0.0;  ///< at the target
    double slope_deg = 0.0;
    double uphill_azimuth_deg = 0.0;           ///< direction of the rise, from north to east
    double roughness_length_m = 50.0;          ///< between the nodes of the roughness that a case draws
    std::shared_ptr<const HeightGrid> grid{};  ///< adds its heights to the plane; none: there is the plane alone
};

/// The descent engines, all alike. Specific impulse goes evenly from least to largest thrust. [facts]
struct EngineDesign {
    double largest_thrust_N = 3603.0;
    double least_thrust_N = 31.0;
    double least_impulse_s = 204.0;  ///< at least thrust
    double most_impulse_s = 223.0;   ///< at largest thrust
};

/// What guidance on board goes by, beside the parameters that ground may change.
struct Guidance {
    double divert_m = 304.0;  ///< the sidestep after backshell separation. [facts]
    double divert_azimuth_deg = 112.0;
    double entry_lift_to_drag = 0.24;            ///< until the forces that are felt tell it
    double engine_impulse_s = 210.0;             ///< by which propellant is counted
    double aim_east_m = 0.0, aim_north_m = 0.0;  ///< where guidance aims, from the target
    /// The bank of the reference, by speed: as before guidance down to the first, in a straight line to the one that is
    /// held from the second to the third, then lift up, reached at the fourth. Our assumption, shaped as [od137] flew.
    double reference_turn_mps = 5300.0;
    double reference_held_from_mps = 4400.0;
    double reference_held_to_mps = 1100.0;
    double reference_up_mps = 980.0;
    double reference_end_mps = 48.0;  ///< so much above the parachute's speed it ends, for SUFR. [facts] 453, 405 m/s
};
inline constexpr double aim_max_m = 20'000.0;  ///< our assumption: what a footprint's centre may be off

/// Drag and lift of the entry vehicle by those of the published table, by Mach number: linear between rows, held
/// outside them.
struct AeroScale {
    double mach = 0.0;
    double drag = 1.0;
    double lift = 1.0;
};

/// Scale of the density by height above the landing radius: density = table × scale. Linear between rows, held outside.
struct DensityScale {
    double altitude_m = 0.0;
    double scale = 1.0;
    /// One standard deviation of a case's density, as a fraction. Where any row has one, they are in place of
    /// Dispersions::density_fraction and density_aloft_fraction.
    double deviation = 0.0;
};

/// The air at a height above the landing radius. Between rows density is interpolated exponentially, temperature
/// linearly; outside them the last layers continue.
struct AirRow {
    double altitude_m = 0.0;
    double temperature_K = 0.0;
    double density_kgm3 = 0.0;
};

/// The wind at a height above the landing radius, linear between rows, held outside them.
struct WindRow {
    double altitude_m = 0.0;
    double east_mps = 0.0, north_mps = 0.0;
};

/// A pass of an orbiter: it hears the vehicle's UHF from rise to set, and relays it to Earth.
struct RelayPass {
    /// From `after_rise_s` on, the rover sends its files at this rate.
    struct Rate {
        double after_rise_s = 0.0;
        double bps = 0.0;
    };
    std::string orbiter;  ///< "odyssey": names its links
    bool stored = false;  ///< it records, and delivers later; false: a bent pipe
    double rise_after_entry_s = 0.0, set_after_entry_s = 0.0;
    double horizon_km = 0.0, nearest_km = 0.0;  ///< range at rise and set, and half-way between
    double delivery_after_set_s = 0.0;          ///< stored: delivery to Earth begins,
    double delivery_rate_bps = 2.0e6;           ///< at that rate
    std::vector<Rate> rates;                    ///< none: the radio's relay_rate_bps throughout
};

/// A planned interval in which tones may be lost, so that ground expects none.
struct ToneOutage {
    std::string name;                 ///< "line stretch"
    std::string event;                ///< a true event, as "parachute_deploy", or "earth_set"
    double from_s = 0.0, to_s = 0.0;  ///< after the event
};

/// A time in which a station on Earth can send to the vehicle.
///
/// Begin and end of track by Earth's clock, in seconds after the UTC of entry. Commands arrive a light time later.
struct TrackingPass {
    std::string station;  ///< "DSS-43"
    double begin_after_entry_s = 0.0, end_after_entry_s = 0.0;
};

struct Radio {
    double light_time_s = 0.0;
    double uhf_rate_bps = 8000.0;
    double blackout_start_speed_mps = 5400.0;  ///< plasma: between these two speeds after entry, while decelerating
    double blackout_end_speed_mps = 2400.0;
    double blackout_start_altitude_m = 65000.0;
    double uhf_loss_fraction = 0.0;     ///< of the octets outside the blackout, garbled in error bursts
    double uhf_burst_s = 0.2;           ///< mean length of those bursts. Our assumption
    double uplink_loss_fraction = 0.0;  ///< of the uplink's octets, garbled in bursts
    double x_band_c_n0_dbhz = 22.0;     ///< total power to noise density in an antenna's best direction
    /// True: tones from a real receiver on a real waveform; false: drawn from the symbol error rate. None: the
    /// rehearsal chooses by its pace; elsewhere they are drawn.
    std::optional<bool> tones_from_samples;
    std::optional<double> earth_set_after_entry_s;  ///< no tone after that; none: Earth sets behind the terrain
    std::vector<ToneOutage> tone_outages;
    double relay_rate_bps = 2.0e6;  ///< of the recording, after landing
    double relay_start_after_touchdown_s = 20.0;
    /// The range of a pass at which uhf_loss_fraction holds; the fraction grows with the square of the range.
    double uhf_loss_range_km = 1000.0;
    double uhf_hand_over_s = 0.0;               ///< outage while the vehicle changes antennas. Our assumption
    std::vector<RelayPass> relay_passes;        ///< none: one bent pipe, always in view, regardless of range
    std::vector<TrackingPass> tracking_passes;  ///< none: some station always sees the vehicle
    std::vector<double> delivery_restarts_after_touchdown_s;  ///< a fault: the rover's file delivery restarts
};

/// A command of the scenario's own script, by its name.
struct ScriptedCommand {
    double send_before_entry_s = 0.0;
    std::string command;
    std::vector<std::pair<std::string, double>> arguments;
    bool from_solution = false;  ///< fill the arguments from ground's navigation solution
};

/// A temporary fault on the spacecraft outside EDL, for which its fault protection may hold EDL. R24
struct SystemFault {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
};

/// A temporary fault of one unit of a device; simulation/buses/device_faults.hpp gives the effects. R2
struct DeviceFault {
    enum class Kind : std::uint8_t { silent, refuses, late, dropout, doubled, claims, denies };
    flight::Device device{};
    flight::Unit unit{};
    Kind kind{};
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double late_s = 5.0;  ///< our assumption: longer than every reply time-out of the timeline
};

/// A failure and restart of the prime computer. R32, R33
struct ComputerReset {
    double before_entry_s = 0.0;  ///< a multiple of 1/64 s; negative after entry
};

/// An outage of the station or the line from it: what reaches Earth meanwhile is lost to ground. Commands still leave.
struct StationOutage {
    double begin_before_entry_s = 0.0;  ///< by Earth's clock: before entry itself, not before its signal arrives
    double duration_s = 0.0;
};

/// An orbiter in safe mode: none hears the vehicle or relays for it. By the vehicle's clock, as the two below.
struct OrbiterOutage {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
};

/// UHF is worse for a while.
struct UhfLoss {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double fraction = 0.0;  ///< of the octets that is garbled at least, as Radio::uhf_loss_fraction
};

/// The air moves otherwise for a while, at all heights: added to the wind.
struct WindShift {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double east_mps = 0.0;
    double north_mps = 0.0;
};

/// The air is denser for a while, at all heights, by that fraction of it.
struct AirShift {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double fraction = 0.0;
};

/// An IMU or radar measures wrongly for a while, and says nothing of it.
struct SensorError {
    flight::Device device{};
    flight::Unit unit{};
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double off_by = 0.0;       ///< IMU: each accelerometer [m/s²]; radar: the velocity by each beam [m/s]
    double grows_per_s = 0.0;  ///< added for each second since it began
    double now(double before_entry_s) const { return off_by + grows_per_s * (begin_before_entry_s - before_entry_s); }
};

/// The vehicle sends this tone in place of its own while it sends tones: it says what is not so.
struct FalseTone {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    ToneId tone{0};
};

/// Whether what begins and lasts so goes on now.
template <typename Spell>
bool goes_on(const Spell& spell, double before_entry_s) {
    return before_entry_s <= spell.begin_before_entry_s &&
           before_entry_s > spell.begin_before_entry_s - spell.duration_s;
}

/// The faults that an instructor may inject during a landing.
using Fault = std::variant<SystemFault, DeviceFault, ComputerReset, StationOutage, OrbiterOutage, UhfLoss, WindShift,
                           AirShift, SensorError, FalseTone>;

/// The limits of a landing. A rover that lands outside them still stands; limits.hpp reports by how much they were
/// exceeded.
struct Limits {
    double propellant_left_min_kg = 4.0;        ///< after fly-away: 1 % of the load cannot be drawn. Our assumption
    double touchdown_vertical_max_mps = 0.85;   ///< [facts] Dispersed landings (M)
    double touchdown_horizontal_max_mps = 0.5;  ///< [facts] (M)
    double touchdown_tilt_max_deg = 10.0;       ///< of the descent stage off the vertical. Our assumption
    double recontact_min_m = 25.0;             ///< to a jettisoned body once clear: a parachute's width. Our assumption
    double parachute_mach_max = 2.2;           ///< [sengupta-2009], at the mortar
    double parachute_pressure_max_Pa = 750.0;  ///< the same
    double timeline_margin_min_s = 0.5;        ///< from the timeline being ready to GNC's decision. Our assumption
    /// Of a campaign's cases, those that land within the limits above. Our assumption: 3 sigma.
    double campaign_within_min_fraction = 0.997;
};

/// The part of the flight software that flies, and what stands in for the rest. The software is the same in each. R36
enum class TestVenue : std::uint8_t {
    flight_software,  ///< all of it
    gnc_alone,        ///< EdlGnc, with a few lines in place of the timeline
    all_but_gnc,      ///< a stand-in for EdlGnc looks at the truth
    performance,      ///< all of it as tasks of the threaded executive, with each message timed
};

/// "flight_software", …
const char* name_of(TestVenue venue);

/// What guidance and navigators take for true. The scenario is the truth, the start is the same in both.
struct Belief {
    Masses masses;
    std::vector<DensityScale> density_scale;
    std::vector<AeroScale> aero_scale;
    double parachute_drag_area_m2 = 0.0;
    double steady_wind_east_mps = 0.0;
    double steady_wind_north_mps = 0.0;
    /// Gravity near the ground is taken for so much stronger; the excess fades to none 100 km up. Of the vehicle alone.
    double gravity_fraction = 0.0;
    /// Ground's solution less the truth, at entry. Added to what a case draws.
    double position_east_m = 0.0, position_north_m = 0.0, position_up_m = 0.0;
    /// Rotation vector in B from the true attitude to that of cruise. Added to what a case draws.
    double attitude_x_deg = 0.0, attitude_y_deg = 0.0, attitude_z_deg = 0.0;
    std::vector<AirRow> air{};     ///< as of the scenario
    std::vector<WindRow> winds{};  ///< as of the scenario
};

struct Scenario {
    std::string name;
    std::string title;             ///< one line, for people
    Scet entry_scet;               ///< of entry interface, 2012-08-06T05:10:47.4
    Sclk entry_sclk{397501715.0};  ///< at entry interface
    double start_before_entry_s = 1200.0;
    double end_after_touchdown_s = 30.0;
    double timeout_after_entry_s = 900.0;
    /// The time at which dispersions are drawn; none: at the start. Until then the flight has none.
    std::optional<double> disperse_before_entry_s;
    EntryState entry;
    Target target;
    Ground ground;
    Masses masses;
    Gyration gyration;
    Stations stations;
    Dispersions dispersions;
    Limits limits;
    std::vector<DensityScale> density_scale;
    std::vector<AirRow> air;                ///< none: Gale's, simulation/mars/atmosphere.cpp
    std::vector<WindRow> winds;             ///< beside the steady wind
    double parachute_drag_area_m2 = 205.0;  ///< CD·S at terminal speed
    double parachute_lift_to_drag = 0.17;  ///< its trim angle makes it lift. [od137] 0.15 at opening, 0.13 … 0.21 later
    double wrist_damping_Nms = 900.0;      ///< of the swing below the bridles' confluence. Our assumption
    double steady_wind_east_mps = 0.0;
    double steady_wind_north_mps = 0.0;
    std::vector<AeroScale> aero_scale;
    EngineDesign engines;
    Guidance guidance;
    flight::Parameters parameters;   ///< that the vehicle is loaded with; each within its range by parameters.csv
    std::optional<Belief> believed;  ///< none: all is known as it is
    Radio radio;
    /// Ground keeps a flight of its own beside a run. None: the rehearsal chooses by its pace; elsewhere there is none.
    std::optional<bool> ground_flight;
    TestVenue test_venue = TestVenue::flight_software;
    flight::Plan telemetry_plan = flight::Plan::mission;
    double parachute_speed_mps = 405.0;  ///< trigger in ground's solution
    double heatshield_speed_mps = 142.0;
    double backshell_altitude_m = 1660.0;
    std::vector<ScriptedCommand> commands;
    std::vector<std::string> second_person;  ///< commands that need a second controller's approval
    std::vector<SystemFault> system_faults;
    std::vector<DeviceFault> device_faults;
    std::vector<ComputerReset> computer_resets;
    std::vector<StationOutage> station_outages;
    std::vector<OrbiterOutage> orbiter_outages;
    std::vector<UhfLoss> uhf_losses;
    std::vector<WindShift> wind_shifts;
    std::vector<AirShift> air_shifts;
    std::vector<SensorError> sensor_errors;
    std::vector<FalseTone> false_tones;
    double bus_message_error_fraction = 1.0e-4;  ///< of the messages on the buses, at each transmission. Our assumption
};

/// Maximum rows of a list in a scenario. Our assumption: more than a landing needs, and few enough that looking at all
/// of them in every cycle costs little, whoever wrote the scenario.
inline constexpr std::size_t scenario_passes_max =
    128;  ///< of orbiters or stations: five a day over the whole permitted time
inline constexpr std::size_t scenario_rows_max = 256;  ///< of any other list

/// Whether the dispersions are drawn after the start, so that all cases share the flight up to then.
bool disperses_later(const Scenario& scenario);
/// The scenario with every seeded error switched off: `dispersions`, and deviations of density by height.
Scenario undispersed(Scenario scenario);
/// Where entry guidance aims: the target, moved by what the scenario says.
Target aimed_target(const Scenario& scenario);
/// The scenario with what is believed in place of the truth: the world that guidance is designed for, and in which
/// ground flies along. Position, attitude and gravity stay true.
Scenario as_believed(Scenario scenario);

/// Azimuth of the course from entry to the target, at the target, from north to east, 0 … 360.
double course_at_target_deg(const Scenario& scenario);

/// Returns one line for each impossible field, as "entry.speed_mps: -3 is outside 1000 … 20000"; empty: none.
std::vector<std::string> impossible_values(const Scenario& scenario);

}  // namespace aeolis::simulation
