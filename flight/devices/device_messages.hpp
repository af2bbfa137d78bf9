// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/ids.hpp"
#include "common/space_packet.hpp"
#include "common/time.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

// Inputs and outputs of a flight computer, at its border with the vehicle.
// The simulation knows this folder and the computer's one step, and nothing else of flight. Plain numbers in SI; no
// Eigen types, no pointers.
//
// Frames (docs/frames_and_units.md): M is fixed to rotating Mars, origin at its centre, z along the spin axis, x
// through the prime meridian. B is fixed to the vehicle, z along the symmetry axis: towards the heatshield in entry,
// down in powered descent. A quaternion q_MB is {w, x, y, z}, unit, and transforms components in B to M.
namespace aeolis::flight {

// ---- redundant units -------------------------------------------------------------------------------------------

/// One of the two units of a redundant device. The choice is commanded before EDL and then fixed. R2
enum class Unit : std::uint8_t { a, b };
/// The devices; which of them have two units is our assumption. Both units of a device act on the same hardware.
/// They are cross-coupled to the same pyros, thrusters, engines and antennas; each unit of a sensor has its own errors.
enum class Device : std::uint8_t { radar, imu, pyro, descent_engines, thrusters, power, uhf, x_band, rover_imu };
inline constexpr std::size_t device_count = 9;
inline constexpr std::size_t redundant_device_count = 8;  ///< with two units: all before the rover's own IMU

/// The addressed unit of each device that has two.
class UnitSelection {
  public:
    Unit operator[](Device device) const { return units_[static_cast<std::size_t>(device)]; }
    Unit& operator[](Device device) { return units_[static_cast<std::size_t>(device)]; }
    bool operator==(const UnitSelection&) const = default;

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(units_);
    }

  private:
    std::array<Unit, redundant_device_count> units_{};
};

// ---- to the computer -------------------------------------------------------------------------------------------

/// One reading of the IMU, 200 Hz: the increments since the previous reading, in B.
struct ImuSample {
    std::uint32_t count = 0;                  ///< 200 Hz count since the unit was started
    std::array<double, 3> delta_v_mps{};      ///< specific force × time
    std::array<double, 3> delta_angle_rad{};  ///< rate relative to inertial space × time
};

/// The newest reading of the rover's own IMU, means over 5 ms along axes fixed to the rover.
/// NaN: the unit says that its data fail.
struct RoverImuReading {
    std::array<double, 3> force_mps2{};  ///< specific force
    std::array<double, 3> rate_rps{};    ///< relative to inertial space
};

/// Initial attitude from cruise attitude determination (star scanner), once a second until separation.
struct CruiseAttitude {
    std::array<double, 4> q_MB{1, 0, 0, 0};
    Sclk at{};  ///< the tick at which it is valid
};

inline constexpr std::size_t radar_beam_count = 6;

/// One velocity and slant-range measurement of the landing radar along one beam.
struct RadarBeam {
    std::uint8_t beam = 0;                ///< 0 … 5
    std::array<double, 3> direction_B{};  ///< unit, from the vehicle towards the ground
    bool valid = false;
    double range_m = 0.0;
    double range_rate_mps = 0.0;  ///< positive: increasing range
};

enum class PyroId : std::uint8_t {
    cruise_cable_cutter,
    cruise_stage_separation,
    cruise_balance_1,
    cruise_balance_2,
    entry_balance_1,
    entry_balance_2,
    entry_balance_3,
    parachute_mortar,
    heatshield_separation,
    engine_valves,
    backshell_separation,
    rover_separation,
    bridle_cutter,
    coolant_vent,
    pressurant_valve_1,
    pressurant_valve_2,
    thermal_batteries,
};
inline constexpr std::size_t pyro_count = 17;

/// Reply of a pyro controller: the pyro fired, or the controller refuses to fire it.
/// A device that does not answer sends nothing over the bus; only a time-out shows it.
struct PyroReply {
    PyroId pyro{};
    bool fired = false;
    Unit unit = Unit::a;  ///< the unit that answered
};
enum class SwitchId : std::uint8_t {
    radar,
    uhf,
    descent_imu,
    entry_antenna,
    parachute_antenna,
    thruster_heaters,
    x_band_tones,  ///< X-band sends tones; off: telemetry
};
inline constexpr std::size_t switch_count = 7;
/// Whether the telecom units hold the switch; the power unit holds the others.
constexpr bool is_telecom(SwitchId id) {
    return id == SwitchId::uhf || id == SwitchId::entry_antenna || id == SwitchId::parachute_antenna ||
           id == SwitchId::x_band_tones;
}
/// The device whose unit is commanded to switch `id`.
constexpr Device switched_by(SwitchId id) {
    if (!is_telecom(id)) return Device::power;
    return id == SwitchId::uhf ? Device::uhf : Device::x_band;
}
struct SwitchReply {
    SwitchId id{};
    bool on = false;  ///< present state
    Unit unit = Unit::a;
    bool refused = false;
};
struct EngineReply {
    bool running = false;
    double thrust_N = 0.0;  ///< sum of the engines, from their pressure sensors
};
struct ThrusterReply {
    bool enabled = false;  ///< present state
    Unit unit = Unit::a;
    bool refused = false;
};
struct BridleReply {
    double payed_out_m = 0.0;  ///< 0 … 7.5
};

/// Report of the spacecraft's own monitors, outside EDL: whether a fault must be repaired first. R24
struct SystemFaultReport {
    bool present = false;
};

/// A telecommand packet from the receiver, as received and unchecked.
struct UplinkPacket {
    std::array<std::uint8_t, packet_octets_max> octets{};
    std::uint16_t size = 0;
};

/// A computer's EDL state, framed for the line between computers and for non-volatile memory.
/// Only flight reads it. See flight/cross_string. The size is chosen: a third more than what the state takes.
inline constexpr std::size_t state_octets_max = 6144;
using StateOctets = FixedVector<std::uint8_t, state_octets_max>;

/// All inputs of the computer with one tick of its clock.
struct DeviceInputs {
    Sclk now;                       ///< the tick
    bool prime_is_b = false;        ///< the latch that designates the prime computer. R1
    bool other_runs_buses = false;  ///< a monitor on the buses saw the other computer run them in the previous cycle
    StateOctets cross_string;       ///< sent by the other computer in the previous cycle; empty: nothing
    StateOctets restart_record;     ///< once, in the first cycle after a restart, if stored
    FixedVector<ImuSample, 4> imu;  ///< 3 or 4 per cycle
    std::optional<CruiseAttitude> cruise_attitude;
    FixedVector<RadarBeam, radar_beam_count> radar;  ///< each beam at 20 Hz
    std::optional<RoverImuReading> rover_imu;        ///< with each frame of the 8 Hz bus
    FixedVector<PyroReply, 16> pyro_replies;
    FixedVector<SwitchReply, 8> switch_replies;
    std::optional<EngineReply> engines;             ///< each cycle once the valves are open
    std::optional<ThrusterReply> thrusters;         ///< on change
    std::optional<BridleReply> bridle;              ///< each cycle after rover separation
    std::optional<SystemFaultReport> system_fault;  ///< each second during a fault, and once when it is over
    FixedVector<UplinkPacket, 2> uplink;
    std::uint32_t nvm_used_octets = 0;
    std::uint32_t nvm_capacity_octets = 0;
};

// ---- from the computer -----------------------------------------------------------------------------------------

/// Burn time of each entry thruster in the cycle that begins when this arrives.
/// Without a command the valves close. flight/devices/effectors.hpp gives the thrusters' positions.
struct ThrusterCommand {
    std::array<double, 8> on_s{};  ///< 0 … 1/64 s
    bool operator==(const ThrusterCommand&) const = default;
};
struct EngineCommand {
    bool ignited = false;
    std::array<double, 8> throttle{};  ///< of each engine, 0 … 1 of its maximum thrust
};

/// One packet to be recorded or sent.
struct PacketOut {
    std::array<std::uint8_t, packet_octets_max> octets{};
    std::uint16_t size = 0;
};

/// Octets of whole packets, one after another.
template <std::size_t N>
using OctetBuffer = FixedVector<std::uint8_t, N>;

/// Firing of a pyro by one of the two controllers. Each pyro has two initiators, one per controller.
struct PyroCommand {
    PyroId id{};
    Unit unit = Unit::a;
    bool operator==(const PyroCommand&) const = default;
};

struct SwitchCommand {
    SwitchId id{};
    bool on = false;
};

using SwitchCommands = FixedVector<SwitchCommand, 8>;

inline constexpr std::size_t nvm_octets_per_cycle = 65536, uhf_octets_per_cycle = 8192;  ///< chosen

/// All outputs of the computer in one cycle.
struct DeviceOutputs {
    UnitSelection units;  ///< to which this cycle's commands are addressed, except pyros
    FixedVector<PyroCommand, 16> pyros;
    SwitchCommands switches;  ///< of the power unit
    SwitchCommands telecom;   ///< of the telecom units
    std::optional<bool> thrusters_enabled;
    ThrusterCommand thrusters;
    EngineCommand engines;
    bool pay_out_bridle = false;
    std::optional<ToneId> tone;  ///< for X-band in this cycle, on the air while it sends tones; none: carrier only
    OctetBuffer<nvm_octets_per_cycle> nvm;  ///< packets to append to the recording, in order
    OctetBuffer<uhf_octets_per_cycle> uhf;  ///< PLTUs to radiate, by X-band in cruise; their packets are recorded too
    StateOctets cross_string;               ///< to the other computer; empty: nothing in this cycle
    StateOctets restart_record;             ///< replaces the stored record; empty: keep that
    std::optional<bool> designate_b_prime;  ///< sets the latch
    bool in_command = false;                ///< the bus listens to this computer
    bool wants_restart_record = false;      ///< requests the restart record with the next tick, while starting

    /// Clears the commands for the next cycle; units and engines keep their last command.
    void begin_cycle() {
        pyros.clear();
        switches.clear();
        telecom.clear();
        thrusters_enabled.reset();
        thrusters = {};
        nvm.clear();
        uhf.clear();
        cross_string.clear();
        restart_record.clear();
        designate_b_prime.reset();
        wants_restart_record = false;
    }
};

}  // namespace aeolis::flight
