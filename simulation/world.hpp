// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/load.hpp"
#include "simulation/buses/bus.hpp"
#include "simulation/landing.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

// What the flight software flies: Mars, the vehicle, its sensors and devices, without a computer and without the links
// home. A closed-loop harness steps it like this:
//
//     World world{scenario, seed, case_number};
//     flight::DeviceOutputs out;
//     while (world.outcome() == Outcome::running) {
//         const flight::DeviceInputs& in = world.sense();   // everything that reaches the computer with this tick
//         out.begin_cycle();  computer(in, out);            // what it commands in this cycle
//         world.advance(out);                               // 1/64 s later
//     }
namespace aeolis::simulation {

/// In       DeviceOutputs of each 64 Hz cycle             Out   DeviceInputs of the next tick, truth and its events
/// Memory   about 20 kB, made once; advance() allocates nothing but an event's name
/// Faults   a state that is not finite ends the run as `lost`
/// Copying a world is a fork: two copies fed the same outputs stay bit-identical.
class World {
  public:
    /// `case_number` selects an independent draw of all dispersions under the same seed. When the scenario has them
    /// drawn later, whoever flies this calls disperse() then; until that nothing of the case shows.
    World(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0);
    World(const World&);
    World& operator=(const World&);
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;
    ~World();

    /// Draws all dispersions now, for a scenario in which they are drawn later than at the start. The truth moves by
    /// the delivery error and ground's solution with it and by the knowledge error, so that at entry both are spread as
    /// if they had been drawn at the start. Returns how much the navigation on board must move to know what ground
    /// knows, and of its instruments what it would have learnt.
    flight::NavigationShift disperse(std::uint64_t seed, std::uint64_t case_number);

    /// What reaches the computer with the tick that is now. Once for each tick; valid until the next call.
    /// The vehicle's computers add what they tell each other.
    flight::DeviceInputs& sense();

    /// The vehicle takes the commands of this cycle and flies on to the next tick.
    void advance(const flight::DeviceOutputs& out);
    /// Flies on to the next tick while no computer runs the buses: thrusters close, engines keep their throttles for 2
    /// s.
    void advance_uncommanded();

    /// An uplinked unit (CLTU) reaches the receiver with the next tick; false when it is too long for one.
    bool receive(std::span<const std::uint8_t> cltu);
    /// Something breaks, when it says.
    void inject(const DeviceFault& fault);
    void inject(const SystemFault& fault);
    /// The vehicle's recorder tells the computer how full it is.
    void set_nvm(std::uint32_t used_octets, std::uint32_t capacity_octets);

    Sclk sclk() const;  ///< of the tick that is now
    TruthState truth() const;
    /// Moments that the last sense() or advance() brought to light; a moment's own time may lie some cycles back.
    std::span<const TruthEvent> events() const;
    Outcome outcome() const;  ///< `touchdown` once the rover stands and the stage has flown away
    const std::string& outcome_reason() const;
    const std::optional<TouchdownReport>& touchdown() const;  ///< from the rover's first contact
    std::optional<Sclk> contact() const;                      ///< when that was
    double peak_deceleration_mps2() const;
    SeparationReport separation() const;
    const NavigationSolution& solution() const;
    bool uhf_on() const;                ///< the selected transmitter radiates through an antenna
    bool parachute_antenna_on() const;  ///< else that of entry
    /// The way to Earth for X-band: above the terrain, and the selected antenna's gain towards it (none: none is
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
