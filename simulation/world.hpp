// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/load.hpp"
#include "simulation/buses/bus.hpp"
#include "simulation/draws.hpp"
#include "simulation/landing.hpp"
#include "simulation/placed_state.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

// The flight software's environment: Mars, the vehicle, its sensors and devices, without computers and links home.
//
// A closed-loop harness steps it like this:
//
//     World world{scenario, seed, case_number};
//     flight::DeviceOutputs out;
//     while (world.outcome() == Outcome::running) {
//         const flight::DeviceInputs& in = world.sense();   // everything that reaches the computer with this tick
//         out.begin_cycle();  computer(in, out);            // its commands in this cycle
//         world.advance(out);                               // 1/64 s later
//     }
namespace aeolis::simulation {

/// The environment of one landing.
///
/// In       DeviceOutputs of each 64 Hz cycle             Out   DeviceInputs of the next tick, truth and its events
/// Memory   about 20 kB, made once; advance() allocates nothing but an event's name
/// Faults   a state that is not finite ends the run as `lost`
/// Copying a world is a fork: two copies fed the same outputs stay bit-identical.
class World {
  public:
    /// `case_number` selects an independent draw of all dispersions under the same seed. When the scenario has them
    /// drawn later, the caller calls disperse() then; until that nothing depends on the case.
    World(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0);
    World(const World&);
    World& operator=(const World&);
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;
    ~World();

    /// Draws all dispersions now, for a scenario in which they are drawn after the start.
    ///
    /// The truth moves by the delivery error; ground's solution moves with it and by the knowledge error. At entry both
    /// have the spread of a draw at the start. Returns the shift of the on-board navigation: to what ground knows, and
    /// to what the instruments would have measured.
    flight::NavigationShift disperse(std::uint64_t seed, std::uint64_t case_number);

    /// Draws anew, in a flight under way, what lies ahead; see Landing::redraw.
    void redraw(std::uint64_t seed, std::uint64_t case_number, const std::optional<StateKnowledge>& knowledge);

    /// Moves the true state.
    void shift(const flight::NavigationShift& by);

    /// The present state, without the computer's.
    PlacedState placed_state() const;
    /// Sets it, and with it the time. For a state between cruise-stage separation and touchdown.
    void place(const PlacedState& state);

    /// Returns the computer's inputs of the present tick. Call once a tick; valid until the next call. The vehicle's
    /// computers add their messages to each other.
    flight::DeviceInputs& sense();

    /// Takes the commands of this cycle and advances to the next tick.
    void advance(const flight::DeviceOutputs& out);
    /// Advances to the next tick while no computer runs the buses: thrusters close, engines keep their throttles for 2
    /// s.
    void advance_uncommanded();

    /// Gives a CLTU to the receiver with the next tick; false when it is too long.
    bool receive(std::span<const std::uint8_t> cltu);
    /// Injects a fault at its own start time.
    void inject(const DeviceFault& fault);
    void inject(const SystemFault& fault);
    void inject(const WindShift& shift);
    void inject(const AirShift& shift);
    void inject(const SensorError& error);
    /// Reports the recorder's fill level to the computer.
    void set_nvm(std::uint32_t used_octets, std::uint32_t capacity_octets);

    Sclk sclk() const;  ///< of the present tick
    TruthState truth() const;
    /// Events found by the last sense() or advance(). An event's own time may be some cycles earlier.
    std::span<const TruthEvent> events() const;
    Outcome outcome() const;  ///< `touchdown` once the rover stands and the stage has flown away
    const std::string& outcome_reason() const;
    const std::optional<TouchdownReport>& touchdown() const;  ///< from the rover's first contact
    std::optional<Sclk> contact() const;                      ///< time of that contact
    double peak_deceleration_mps2() const;
    SeparationReport separation() const;
    const NavigationSolution& solution() const;
    std::vector<Draw> draws() const;    ///< the errors of this case, of the units A where there are two
    bool uhf_on() const;                ///< the selected transmitter radiates through an antenna
    bool parachute_antenna_on() const;  ///< false: the entry antenna
    bool x_band_sends_tones() const;    ///< commanded to; false: to send telemetry, through the cruise stage's antenna
    bool cruise_stage_on() const;
    /// The X-band path to Earth: whether it is above the terrain, and the gain of the selected antenna (none: none
    /// selected).
    struct EarthView {
        bool up = false;
        std::optional<double> gain;
    };
    EarthView earth_view() const;
    const Bus::Counters& bus_64_hz() const;
    const Bus::Counters& bus_8_hz() const;

    using Inspection = simulation::Inspection;
    Inspection inspect() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::simulation
