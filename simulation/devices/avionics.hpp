// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/buses/bus.hpp"
#include "simulation/buses/device_faults.hpp"
#include "simulation/placed_state.hpp"

namespace aeolis::simulation {

/// The devices behind the remote terminals: switch positions, fired pyros, and pending replies.
///
/// A command acts when it reaches its terminal; the reply is ready a fixed time later, plus up to 2 ticks of jitter.
/// Our assumptions: pyro 2 ticks (31 ms), thrusters 3, heaters 4, antenna and X-band's mode 6, IMU 8, radar 12
/// (0.19 s), UHF 32 (0.5 s); at start thrusters enabled, both IMUs on, entry antenna selected, radar and heaters off.
/// An antenna that is switched on replaces the other. Both units of a device drive the same hardware; one switch powers
/// the UHF transmitters of both.
/// In a run that starts before the timeline switches to UHF and tones, UHF is off and X-band sends telemetry. A later
/// run starts with both switched.
class Avionics {
  public:
    Avionics(double start_before_entry_s, Random random);
    static constexpr double uhf_start_before_entry_s = 800.0, x_band_tones_before_entry_s = 750.0;  ///< timeline.csv

    /// Draws jitter from `random` from here on.
    void disperse(Random random) { random_ = random; }

    bool on(flight::SwitchId id, flight::Unit unit = flight::Unit::a) const {
        return on_[static_cast<std::size_t>(id)][static_cast<std::size_t>(unit)];
    }
    bool thrusters_enabled() const { return thrusters_enabled_; }
    bool fired(flight::PyroId pyro) const { return fired_[static_cast<std::size_t>(pyro)]; }

    /// Sets what was switched, fired and enabled. Replies under way stay.
    void place(const PlacedState& state);
    void add_to(PlacedState& state) const;

    /// Executes a command that reached its terminal. Returns true when it fired a pyro for the first time.
    bool execute(const BusCommand& command, std::int64_t tick, const DeviceFaults& faults);

    struct Reply {
        std::int64_t ready_tick = 0;
        flight::Device device{};
        flight::Unit unit{};
        BusCommand::Kind kind{};
        flight::PyroId pyro{};
        flight::SwitchId switch_id{};
        bool on = false;  ///< fired, on, enabled
        bool refused = false;
    };
    /// Pending replies, oldest command first. The owner removes those that the bus fetched.
    FixedVector<Reply, 64>& replies() { return replies_; }

  private:
    Reply obey(const BusCommand& command, bool& first_firing);
    Reply refuse(const BusCommand& command) const;
    static Reply done(const BusCommand& command);
    static Reply deny(const BusCommand& command);

    std::array<std::array<bool, 2>, flight::switch_count> on_{};
    std::array<bool, flight::pyro_count> fired_{};
    bool thrusters_enabled_ = true;
    FixedVector<Reply, 64> replies_;
    Random random_;
};

}  // namespace aeolis::simulation
