// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer.hpp"
#include "flight/computer_state.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/world.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/telecommands.hpp"

#include <vector>

// Computers in the middle of a landing, as a start for tests.
namespace aeolis::test {

/// Two computers that fly the nominal landing in the world, without the links home. A value: a copy is a fork.
class FlownComputers {
  public:
    /// Starts in pre-EDL with EDL begun.
    explicit FlownComputers(const simulation::Scenario& scenario = tests::gale_scenario(900.0))
        : world_(scenario, 1), prime_(simulation::load_for(scenario), world_.sclk()),
          backup_(backup_load(scenario), world_.sclk()) {
        command(set_parameters(world_.solution()));
        command(enable_second_chance());
        command(do_edl());
        AEOLIS_CHECK(prime_.state().edl.timeline().begun());
    }

    void step() {
        flight::DeviceInputs& in = world_.sense();
        in.nvm_capacity_octets = 1U << 30;
        beside_ = {};
        beside_.now = in.now;
        beside_.imu = in.imu;
        beside_.uplink = in.uplink;
        beside_.nvm_capacity_octets = in.nvm_capacity_octets;
        flight::DeviceInputs& of_backup = prime_silent_ ? in : beside_;
        of_backup.cross_string = out_.prime.cross_string;
        if (prime_silent_) {
            out_.prime.begin_cycle();
            out_.prime.in_command = false;
        } else {
            in.cross_string = out_.backup.cross_string;
            prime_.step(in, out_.prime);
        }
        backup_.step(of_backup, out_.backup);
        if (out_.backup.in_command)
            world_.advance(out_.backup);
        else if (out_.prime.in_command)
            world_.advance(out_.prime);
        else
            world_.advance_uncommanded();
    }
    template <typename Moment>
    void fly_until(const Moment& moment) {
        while (!moment(*this)) {
            AEOLIS_CHECK(world_.outcome() == simulation::Outcome::running);
            step();
        }
    }
    void silence_prime() { prime_silent_ = true; }

    const simulation::World& world() const { return world_; }
    flight::Computer& prime() { return prime_; }
    flight::Computer& backup() { return backup_; }
    bool backup_in_control() const { return out_.backup.in_command; }

  private:
    struct Outputs {
        flight::DeviceOutputs prime, backup;
    };
    static flight::Load backup_load(const simulation::Scenario& scenario) {
        flight::Load load = simulation::load_for(scenario);
        load.string = flight::String::b;
        load.role = flight::Role::second_chance;
        return load;
    }
    void command(const std::vector<std::uint8_t>& packet) {
        AEOLIS_CHECK(world_.receive(packet));
        for (int cycle = 0; cycle < 16; ++cycle) step();
    }

    simulation::World world_;
    flight::Computer prime_, backup_;
    Outputs out_;
    flight::DeviceInputs beside_;
    bool prime_silent_ = false;
};

}  // namespace aeolis::test
