#pragma once

#include "simulation/mars/mars.hpp"
#include "simulation/world.hpp"

#include <cmath>
#include <map>
#include <string>

namespace aeolis::tests {

/// Lands the world by looking at its truth: no guidance, no navigation, a few rules of thumb. It is there to fly the
/// models through a whole landing; what flight software makes of them is shown elsewhere.
class TruthPilot {
  public:
    explicit TruthPilot(const simulation::Scenario& scenario, std::uint64_t seed = 1, std::uint64_t case_number = 0)
        : world(scenario, seed, case_number) {}

    simulation::World world;
    std::map<std::string, simulation::TruthEvent> events;
    std::uint64_t digest = 0xcbf29ce484222325ULL;

    void run() {
        while (world.outcome() == simulation::Outcome::running)
            step();
    }
    void run_until(double e_s) {
        while (world.outcome() == simulation::Outcome::running && world.truth().e_s < e_s)
            step();
    }
    void step() {
        const flight::DeviceInputs& in = world.sense();
        for (const auto& sample : in.imu)
            add(sample.delta_v_mps), add(sample.delta_angle_rad);
        for (const auto& beam : in.radar)
            add({beam.range_m, beam.range_rate_mps, 0.0});
        const auto truth = world.truth();
        add(truth.p_MoB_M_m);
        out_.begin_cycle();
        command(truth);
        world.advance(out_);
        for (const auto& event : world.events())
            events.emplace(event.name, event);
    }

  private:
    using Mode = flight::AttitudeCommand::Mode;
    using PyroId = flight::PyroId;

    void add(const std::array<double, 3>& values) {
        for (const double value : values)
            digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3ULL;
    }
    bool once(const std::string& name, bool when) { return when && done_.emplace(name, world.truth().e_s).second; }
    double since(const std::string& name) const {
        const auto found = done_.find(name);
        return found == done_.end() ? -1.0 : world.truth().e_s - found->second;
    }

    void command(const simulation::TruthState& truth) {
        const double speed_mps = truth.speed_mps;
        if (once("separate", truth.e_s >= -600.0)) out_.pyros.push_back(PyroId::cruise_stage_separation);
        if (once("balance", truth.e_s >= -489.0)) {
            out_.pyros.push_back(PyroId::cruise_balance_1);
            out_.pyros.push_back(PyroId::cruise_balance_2);
        }
        if (once("turn", truth.e_s >= -400.0)) out_.attitude.mode = Mode::entry_bank;
        // Roughly the bank of [od137].
        double bank_deg = 72.0;
        if (truth.e_s > 72.0) bank_deg = -48.0;
        if (truth.e_s > 98.0) bank_deg = 46.0;
        if (truth.e_s > 124.0) bank_deg = speed_mps > 1000.0 ? -49.0 : 0.0;
        out_.attitude.bank_rad = bank_deg * simulation::degree_rad;
        if (truth.e_s < 0.0) return;
        if (once("sufr", speed_mps < 453.0)) out_.pyros.push_back(PyroId::entry_balance_1);
        if (once("sufr 2", since("sufr") >= 2.0)) out_.pyros.push_back(PyroId::entry_balance_2);
        if (once("sufr 3", since("sufr") >= 4.0)) out_.pyros.push_back(PyroId::entry_balance_3);
        if (once("mortar", speed_mps < 405.0)) {
            out_.pyros.push_back(PyroId::parachute_mortar);
            out_.attitude.mode = Mode::suspended;
        }
        if (once("heatshield", since("mortar") > 20.0 && speed_mps < 143.0)) {
            out_.pyros.push_back(PyroId::heatshield_separation);
            out_.switches.push_back({flight::SwitchId::radar, true});
        }
        if (once("valves", since("mortar") > 0.0 && truth.altitude_m < 3000.0))
            out_.pyros.push_back(PyroId::engine_valves);
        if (once("backshell", since("mortar") > 0.0 && truth.altitude_m < 1660.0))
            out_.pyros.push_back(PyroId::backshell_separation);
        if (since("backshell") >= 0.0) descend(truth);
    }

    void descend(const simulation::TruthState& truth) {
        using simulation::Vector3;
        const simulation::Horizon local = simulation::horizon(simulation::vector3(truth.p_MoB_M_m));
        const Vector3 v = simulation::vector3(truth.v_MB_M_mps);
        const double up_mps = v.dot(local.up);
        const double height_m = truth.altitude_m;
        // Two stretches of even deceleration, then a slow and steady descent from 32 m on.
        double wanted_mps = -0.75;
        if (height_m > 150.0)
            wanted_mps = -std::min(75.0, std::sqrt(32.0 * 32.0 + 6.0 * (height_m - 150.0)));
        else if (height_m > 32.0)
            wanted_mps = -std::sqrt(0.56 + 8.6 * (height_m - 32.0));
        const double feed_forward_mps2 = height_m > 32.0 ? 3.0 : 0.0;
        const Vector3 horizontal = v - up_mps * local.up;
        const Vector3 push = (3.71 + feed_forward_mps2 + 1.2 * (wanted_mps - up_mps)) * local.up - 0.3 * horizontal;
        const double mass_kg = world.inspect().mass_kg - (world.contact() ? 899.0 : 0.0);
        const double thrust_N = std::min(25000.0, push.norm() * mass_kg);
        out_.attitude.mode = Mode::thrust;
        out_.attitude.thrust_direction_M = simulation::array3(push.normalized());
        out_.engines.ignited = since("backshell") > 1.0;
        const bool four = once("sky crane", height_m < 30.0) || since("sky crane") >= 0.0;
        for (std::size_t i = 0; i < 8; ++i)
            out_.engines.throttle[i] =
                four ? (i < 4 ? 0.0 : (thrust_N - 4 * 31.0) / 4 / 3603.0) : thrust_N / 8 / 3603.0;

        if (once("rover", since("sky crane") > 4.0)) out_.pyros.push_back(PyroId::rover_separation);
        out_.pay_out_bridle = since("rover") >= 0.0;
        if (once("cut", world.contact() && truth.sclk - *world.contact() > 1.5))
            out_.pyros.push_back(PyroId::bridle_cutter);
        if (since("cut") < 0.0) return;
        out_.attitude.thrust_direction_M = simulation::array3((local.up + 0.8 * local.north).normalized());
        out_.engines.throttle.fill(0.9);
        out_.engines.ignited = since("cut") < 6.66;
    }

    flight::DeviceOutputs out_;
    std::map<std::string, double> done_;
};

} // namespace aeolis::tests
