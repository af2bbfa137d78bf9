// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/devices/effectors.hpp"
#include "flight/load.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

// All that makes one landing what it is. Filled by the server from a text file, checked there with `validate`.
namespace aeolis::simulation {

/// Truth at the epoch, relative to rotating Mars, or at entry interface, from where it is propagated back. [facts]
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

/// Radii of gyration by what is attached: about z, and about any axis across it. What flight takes them for is
/// flight/devices/effectors.hpp; a scenario may have others, which then are an error that the vehicle flies with.
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

/// Where the parts' centres of mass sit along z, from the descent stage's own; and how far off the axis the balance
/// masses, which give the 0.1 m of the entry vehicle [facts] (L). Not published: all ours.
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
    double knowledge_position_m = 930.0;  ///< ground's solution against the truth
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
    double imu_misalignment_rad = 1.0e-4;  ///< of the sensors' axes, about each axis of B. Ours
    double gust_mps = 2.0;                 ///< of each horizontal part of gusts near the ground. Ours
    double radar_dropout_fraction = 0.01;  ///< no deviation: the part of the radar's readings that fail. Ours
    double terrain_height_m = 0.0;
    double terrain_slope_deg = 0.0;       ///< of the rise towards east and towards north
    double parachute_plane_deg = 30.0;    ///< of the plane in which the parachute begins to lift, off up. Ours
    double mass_fraction = 0.001;         ///< of all parts alike
    double slow_drag_fraction = 0.033;    ///< of drag and lift at low Mach numbers; drag_fraction is for high ones
    double imu_scale_fraction = 1.0e-4;   ///< of each accelerometer. Ours
    double gyro_scale_fraction = 1.0e-5;  ///< of each gyro. Ours
    double imu_noise_mps = 5.0e-5;        ///< of each accelerometer, a reading. Ours
    double gyro_noise_rad = 2.0e-6;       ///< of each gyro, a reading. Ours
};

/// The ground around the target, over the sphere of its radius; a case adds its own (Dispersions). Ours.
struct Ground {
    double height_m = 0.0;  ///< at the target
    double slope_deg = 0.0;
    double uphill_azimuth_deg = 0.0;  ///< where it rises to, from north to east
};

/// Atmosphere scale by height above the landing radius: density = table × scale.
struct DensityScale {
    double altitude_m = 0.0;
    double scale = 1.0;
};

/// A pass of an orbiter: it hears the vehicle's UHF from rise to set, and hands on to Earth what it heard.
struct RelayPass {
    /// From `after_rise_s` on the rover sends its files at this rate.
    struct Rate {
        double after_rise_s = 0.0;
        double bps = 0.0;
    };
    std::string orbiter;  ///< "odyssey": names its links
    bool stored = false;  ///< it records, and delivers later; else a bent pipe
    double rise_after_entry_s = 0.0, set_after_entry_s = 0.0;
    double horizon_km = 0.0, nearest_km = 0.0;  ///< range at rise and set, and half-way between
    double delivery_after_set_s = 0.0;          ///< stored: from then on Earth receives what it recorded,
    double delivery_rate_bps = 2.0e6;           ///< at that rate
    std::vector<Rate> rates;                    ///< none: the radio's relay_rate_bps throughout
};

/// When tones may be lost by plan: ground counts on none there.
struct ToneOutage {
    std::string name;                 ///< "line stretch"
    std::string event;                ///< of the truth, as "parachute_deploy", or "earth_set"
    double from_s = 0.0, to_s = 0.0;  ///< after the event
};

/// When a station on Earth can send to the vehicle: begin and end of track by Earth's clock, as seconds after the UTC
/// of entry. What leaves then is at the vehicle a light time later.
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
    double uhf_loss_fraction = 0.0;     ///< of the octets outside the blackout, spoilt in bursts of errors
    double uhf_burst_s = 0.2;           ///< mean length of those. Ours
    double uplink_loss_fraction = 0.0;  ///< of the octets of the uplink, spoilt in bursts
    double x_band_c_n0_dbhz = 22.0;     ///< total power to noise density in an antenna's best direction
    /// Tones by a real receiver from a real waveform, or drawn from its symbol error. None: whoever flies the landing
    /// chooses by the pace; nobody else does, so that they are drawn.
    std::optional<bool> tones_from_samples;
    std::optional<double> earth_set_after_entry_s;  ///< no tone after that; none: when it sets behind the terrain
    std::vector<ToneOutage> tone_outages;
    double relay_rate_bps = 2.0e6;  ///< of the recording, after landing
    double relay_start_after_touchdown_s = 20.0;
    /// Outside its bursts a pass is as good as at this range; the part of spoilt octets grows with the square of the
    /// range.
    double uhf_loss_range_km = 1000.0;
    double uhf_hand_over_s = 0.0;               ///< nothing arrives for so long when the vehicle changes antennas. Ours
    std::vector<RelayPass> relay_passes;        ///< none: one bent pipe, always in view, without regard to range
    std::vector<TrackingPass> tracking_passes;  ///< none: some station always sees the vehicle
    std::vector<double> delivery_restarts_after_touchdown_s;  ///< the rover's delivery of files begins anew: a fault
};

/// A command of the scenario itself ("commands scripted"), by name as a controller would send it.
struct ScriptedCommand {
    double send_before_entry_s = 0.0;
    std::string command;
    std::vector<std::pair<std::string, double>> arguments;
    bool from_solution = false;  ///< fill the arguments from ground's navigation solution
};

/// Something on the spacecraft is broken for a while, outside EDL: its fault protection may hold EDL meanwhile. R24
struct SystemFault {
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
};

/// One unit of a device misbehaves for a while; simulation/buses/device_faults.hpp says how. R2
struct DeviceFault {
    enum class Kind : std::uint8_t { silent, refuses, late, dropout };
    flight::Device device{};
    flight::Unit unit{};
    Kind kind{};
    double begin_before_entry_s = 0.0;
    double duration_s = 0.0;
    double late_s = 5.0;  ///< ours: longer than every reply time-out of the timeline
};

/// The prime computer fails and starts anew. R32, R33
struct ComputerReset {
    double before_entry_s = 0.0;  ///< a multiple of 1/64 s; negative after entry
};

/// What reaches Earth meanwhile is lost to ground: its station, or the line from there. Commands still leave.
struct StationOutage {
    double begin_before_entry_s = 0.0;  ///< by Earth's clock: before the instant of entry, not before that is seen
    double duration_s = 0.0;
};

/// What an instructor may break while a landing flies.
using Fault = std::variant<SystemFault, DeviceFault, ComputerReset, StationOutage>;

/// What of the flight software flies, and what is simulated beside it; the software is the same in each. R36
enum class TestVenue : std::uint8_t {
    flight_software,  ///< all of it
    gnc_alone,        ///< EdlGnc, with a few lines in place of the timeline
    all_but_gnc,      ///< what stands in for EdlGnc looks at the truth
    performance,      ///< all of it as tasks of the threaded executive, each message timed
};

/// "flight_software", …
const char* name_of(TestVenue venue);

struct Scenario {
    std::string name;
    std::string title;             ///< a line for people
    Scet entry_scet;               ///< of entry interface, 2012-08-06T05:10:47.4
    Sclk entry_sclk{397501715.0};  ///< at entry interface
    double start_before_entry_s = 1200.0;
    double end_after_touchdown_s = 30.0;
    double timeout_after_entry_s = 900.0;
    /// When the dispersions are drawn; none: at the start. Until then everything flies as if there were none.
    std::optional<double> disperse_before_entry_s;
    EntryState entry;
    Target target;
    Ground ground;
    Masses masses;
    Gyration gyration;
    Stations stations;
    Dispersions dispersions;
    std::vector<DensityScale> density_scale;
    double parachute_drag_area_m2 = 205.0;  ///< CD·S at terminal speed
    double steady_wind_east_mps = 0.0;
    double steady_wind_north_mps = 0.0;
    Radio radio;
    TestVenue test_venue = TestVenue::flight_software;
    flight::Plan telemetry_plan = flight::Plan::mission;
    double parachute_speed_mps = 405.0;  ///< trigger of ground's solution
    double heatshield_speed_mps = 142.0;
    double backshell_altitude_m = 1660.0;
    std::vector<ScriptedCommand> commands;
    std::vector<std::string> second_person;  ///< commands that leave only when a second controller has approved them
    std::vector<SystemFault> system_faults;
    std::vector<DeviceFault> device_faults;
    std::vector<ComputerReset> computer_resets;
    std::vector<StationOutage> station_outages;
    double bus_message_error_fraction = 1.0e-4;  ///< of the messages on the buses, each time they are sent. Ours
};

/// How many rows a list of a scenario may have. Ours: more than a landing needs, and so few that looking at all of them
/// in every cycle costs nothing beside the flight, wherever the scenario comes from.
inline constexpr std::size_t scenario_passes_max =
    128;  ///< of orbiters, of stations: five a day over all the time in which one may lie
inline constexpr std::size_t scenario_rows_max = 256;  ///< of each other list

/// Whether the dispersions are drawn later than at the start: all cases then have the flight up to there in common.
bool disperses_later(const Scenario& scenario);
/// The same with every seeded error of `dispersions` switched off.
Scenario undispersed(Scenario scenario);

/// Empty when the scenario is possible; else "entry.speed_mps: -3 is outside 1000 … 20000", one line a field.
std::vector<std::string> impossible_values(const Scenario& scenario);

}  // namespace aeolis::simulation
