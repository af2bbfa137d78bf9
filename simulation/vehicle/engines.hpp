// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vectors.hpp"

#include <array>
#include <optional>

namespace aeolis::simulation {

/// Eight throttled descent engines, each with its own thrust, mounted as in flight/devices/effectors.hpp.
///
/// Thrust and specific impulse are the scenario's.
/// Our assumptions: they ignite 0.15 s after the command, and only when the valves have been open for 5 s (priming);
/// thrust follows the throttle with a time constant of 0.06 s and decays with one of 0.03 s.
class Engines {
  public:
    explicit Engines(const EngineDesign& design = {}) : design_(design) {}

    void open_valves(double now_s);
    bool valves_open() const { return valves_open_; }

    void command(const flight::EngineCommand& command, double now_s);
    /// Advances thrust by `step_s` and returns the propellant burnt in that time [kg].
    double advance(double now_s, double step_s, double propellant_left_kg);

    /// Sets engines that hold this command, with the thrust of its throttles. `valves_s`: when their valves opened.
    void place(const flight::EngineCommand& command, std::optional<double> valves_s);
    std::optional<double> valves_open_since_s() const {
        return valves_open_ ? std::optional{valves_open_since_s_} : std::nullopt;
    }

    bool running() const { return running_; }
    double thrust_N() const { return thrust_sum_N_; }  ///< sum over the engines, each along its own direction
    Vector3 force_B_N() const { return force_B_N_; }
    Vector3 torque_B_Nm() const { return torque_B_Nm_; }

  private:
    void sum_up();
    double asked_N(std::size_t engine) const;

    EngineDesign design_;
    bool valves_open_ = false;
    double valves_open_since_s_ = 0.0;
    bool ignited_ = false;
    bool running_ = false;
    double ignition_s_ = 0.0;
    std::array<double, 8> throttle_{};
    std::array<double, 8> thrust_N_{};
    double thrust_sum_N_ = 0.0;
    Vector3 force_B_N_ = Vector3::Zero(), torque_B_Nm_ = Vector3::Zero();
};

}  // namespace aeolis::simulation
