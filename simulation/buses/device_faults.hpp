// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/scenario.hpp"

#include <array>
#include <vector>

namespace aeolis::simulation {

/// What is broken now, by device and unit.
///
/// silent   its terminal answers nothing on the bus; what it was told before it keeps
/// refuses  its terminal answers, and does not do what it is told
/// late     its replies come a while later than they should
/// dropout  what it carries fails: the radar measures nothing valid, the IMU loses one sample in two, UHF radiates
/// nothing
class DeviceFaults {
  public:
    DeviceFaults(std::vector<DeviceFault> faults, Sclk entry) : faults_(std::move(faults)), entry_(entry) {}

    void add(const DeviceFault& fault) { faults_.push_back(fault); }
    /// To be told each tick before it is asked.
    void at(Sclk now);

    bool has(DeviceFault::Kind kind, flight::Device device, flight::Unit unit) const {
        return (state(device, unit).kinds & bit(kind)) != 0;
    }
    bool answers(flight::Device device, flight::Unit unit) const {
        return !has(DeviceFault::Kind::silent, device, unit);
    }
    /// How much later replies come, in ticks.
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
