// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/buses/bus.hpp"
#include "simulation/buses/device_faults.hpp"
#include "simulation/devices/avionics.hpp"
#include "simulation/links/x_band_antenna.hpp"

namespace aeolis::simulation {

/// The vehicle's two 1553 buses, run by the computer in command, with the devices behind their remote terminals. R2
///
/// 64 Hz   radar, pyro controllers, descent engines with the bridle, thrusters
/// 8 Hz   power switches and heaters, UHF, X-band with the antennas, the rover's own IMU
///
/// The descent stage's IMU is on neither: its samples come over a link of its own.
///
/// In       a cycle's commands, each to the unit that it addresses
/// Out      the devices' actions, and replies for the computer
/// Timing   the commands of cycle n go out with the first frame after it: at 64 Hz with tick n + 1, at 8 Hz with the
///          next multiple of 1/8 s. A reply is fetched by the first frame in which the device has it ready
/// Cyclic   on-times, throttles and pay-out go out in every 64 Hz frame, which also reads radar and engines; every
///          8 Hz frame reads the rover's IMU. Thrusters
///          without a command close at once; engines keep their last throttles for 2 s and then go safe. [facts]
class Buses {
  public:
    Buses(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number);

    /// Starts a campaign case: draws errors and jitter anew; commands under way stay.
    void disperse(std::uint64_t seed, std::uint64_t case_number);

    /// Sets what the devices hold. Commands under way stay.
    void place(const PlacedState& state);
    void add_to(PlacedState& state) const;

    /// Takes the computer's commands of this cycle.
    void take(const flight::DeviceOutputs& out);
    /// Notes that no computer runs the buses in this cycle: no frame begins with the next tick.
    void leave_alone() { commanded_ = false; }
    /// Runs the frames that begin with this tick.
    void frame(Sclk now);

    /// Pyros fired for the first time in the frame of this tick.
    std::span<const flight::PyroId> fired() const { return fired_.span(); }
    const flight::ThrusterCommand& thrusters() const { return thrusters_; }
    const flight::EngineCommand& engines() const { return engines_; }
    bool pay_out_bridle() const { return pay_out_bridle_; }
    const Avionics& devices() const { return devices_; }

    /// Adds the replies fetched by the frames of this tick.
    void reply(flight::DeviceInputs& in) const;
    bool radar_was_read() const { return radar_was_read_; }
    bool rover_imu_was_read() const { return rover_imu_was_read_; }
    bool engines_were_read() const { return engines_were_read_; }
    bool uhf_radiates() const;
    bool parachute_antenna_on() const { return devices_.on(flight::SwitchId::parachute_antenna); }
    bool x_band_sends_tones() const { return devices_.on(flight::SwitchId::x_band_tones); }  ///< false: telemetry
    std::optional<XBandAntenna> x_band_antenna() const;                                      ///< the one selected
    /// Whether the sample now on the IMU's link arrives.
    bool imu_sample_arrives();
    flight::Unit unit(flight::Device device) const { return addressed_[device]; }
    const DeviceFaults& faults() const { return faults_; }
    /// Adds a fault that acts from `now` on, not only from the next frame.
    void inject(const DeviceFault& fault, Sclk now) {
        faults_.add(fault);
        faults_.at(now);
    }

    const Bus::Counters& counters_64_hz() const { return bus_64_hz_.counters(); }
    const Bus::Counters& counters_8_hz() const { return bus_8_hz_.counters(); }

  private:
    void take_switches(const flight::SwitchCommands& commands);
    void run(Bus& bus, std::int64_t tick);
    void run_cyclic(std::int64_t tick);
    void fetch(Bus& bus, std::int64_t tick);
    bool obeys(flight::Device device) const;

    Bus bus_64_hz_;
    Bus bus_8_hz_;
    DeviceFaults faults_;
    Avionics devices_;
    Random imu_link_;

    // Commands of the last cycle.
    flight::UnitSelection addressed_;
    flight::ThrusterCommand thrusters_due_;
    flight::EngineCommand engines_due_;
    bool pay_out_bridle_due_ = false;
    bool commanded_ = false;

    // Commands that the drivers hold.
    flight::ThrusterCommand thrusters_;  ///< of this tick; nil when no command came
    flight::EngineCommand engines_;
    bool pay_out_bridle_ = false;
    std::int64_t engines_tick_ = 0;

    // Results of this tick's frames.
    FixedVector<flight::PyroId, 32> fired_;
    FixedVector<Avionics::Reply, 16> fetched_;
    bool radar_was_read_ = false;
    bool engines_were_read_ = false;
    bool rover_imu_was_read_ = false;
};

}  // namespace aeolis::simulation
