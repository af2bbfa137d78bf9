#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"

#include <cstdint>

namespace aeolis::simulation {

/// Switches, pyros and thrusters as boxes on a bus: what is on, and the replies that come back a little later.
///
/// Effects are at once, replies late by a fixed time and by up to 2 ticks of jitter. The times are ours:
/// pyro 2 ticks (31 ms), thrusters 3, heaters 4, antenna 6, IMU 8, radar 12 (0.19 s), UHF 32 (0.5 s).
/// At start (ours): thrusters enabled, IMU on, entry antenna selected; radar, UHF and heaters off.
/// An antenna that is switched on takes over from the other.
class Avionics {
  public:
    explicit Avionics(Random random) : random_(random) {}

    bool on(flight::SwitchId id) const { return on_[static_cast<std::size_t>(id)]; }
    bool thrusters_enabled() const { return thrusters_enabled_; }

    /// A pyro fires; false when it had fired before (its reply then says so again: it is fired).
    bool fire(flight::PyroId pyro, std::int64_t tick);
    bool fired(flight::PyroId pyro) const { return fired_[static_cast<std::size_t>(pyro)]; }
    void set(const flight::SwitchReply& wanted, std::int64_t tick);
    void enable_thrusters(bool enabled, std::int64_t tick);

    /// Adds the replies that are due to the inputs of this tick. What finds no room waits for the next.
    void reply(std::int64_t tick, flight::DeviceInputs& in);

  private:
    struct Pending {
        std::int64_t due_tick = 0;
        enum class Kind : std::uint8_t { pyro, device, thrusters } kind{};
        flight::PyroId pyro{};
        flight::SwitchId device{};
        bool on = false;
    };
    void later(Pending reply, std::int64_t tick, std::int64_t delay_ticks);

    // In cruise the IMU is on, and telemetry flows: the mission's came over X-band then, here the UHF link stands in for
    // it from the start, so that ground sees the answers to its commands. Ours.
    std::array<bool, 6> on_{false, true, true, true, false, false};
    std::array<bool, flight::pyro_count> fired_{};
    bool thrusters_enabled_ = true;
    FixedVector<Pending, 64> pending_;
    Random random_;
};

} // namespace aeolis::simulation
