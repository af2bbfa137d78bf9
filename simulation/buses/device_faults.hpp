// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/scenario.hpp"

#include <array>
#include <vector>

namespace aeolis::simulation {

/// The present faults, by device and unit.
///
/// silent   the terminal does not answer on the bus; the device keeps its last command
/// refuses  the terminal answers, and the device does not act
/// late     replies come later than they should
/// doubled  each reply comes twice, a tick apart
/// claims   the device does not act, and replies that it did
/// denies   the device acts, and replies that it refuses
/// dropout  the device's data fail: the radar has no valid measurement, the IMU loses every other sample, the rover's
///          own says that its data fail, UHF radiates nothing
class DeviceFaults {
  public:
    DeviceFaults(std::vector<DeviceFault> faults, Sclk entry) : faults_(std::move(faults)), entry_(entry) {}

    void add(const DeviceFault& fault) { faults_.push_back(fault); }
    /// Updates the states for this tick. Call each tick before any query.
    void at(Sclk now);

    bool has(DeviceFault::Kind kind, flight::Device device, flight::Unit unit) const {
        return (state(device, unit).kinds & bit(kind)) != 0;
    }
    bool answers(flight::Device device, flight::Unit unit) const {
        return !has(DeviceFault::Kind::silent, device, unit);
    }
    /// The delay of replies [ticks].
    std::int64_t late_ticks(flight::Device device, flight::Unit unit) const { return state(device, unit).late_ticks; }

  private:
    struct State {
        std::uint8_t kinds = 0;
        std::int64_t late_ticks = 0;
    };
    static constexpr std::uint8_t bit(DeviceFault::Kind kind) {
        return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
    }
    const State& state(flight::Device device, flight::Unit unit) const {
        return states_[static_cast<std::size_t>(device)][static_cast<std::size_t>(unit)];
    }

    std::vector<DeviceFault> faults_;
    Sclk entry_;
    std::array<std::array<State, 2>, flight::device_count> states_{};
};

}  // namespace aeolis::simulation
