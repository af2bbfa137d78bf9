// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer.hpp"

#include <array>
#include <memory>
#include <utility>

namespace aeolis::simulation {

/// The vehicle's two flight computers, the latch that designates prime, the line between them, the memory that keeps a
/// state over a restart, and the bus, which listens to one of them.
///
/// In       what reaches the computer in command with a tick; both hear the clock, the IMU's own link and the receiver
/// Out      the commands that the bus takes, and what either computer records and radiates
/// Faults   when neither is in command nobody runs the buses; what devices then do is theirs (simulation/buses)
/// Copying it is a fork, as of all the vehicle.
class Computers {
  public:
    Computers(const flight::Load& load, Sclk start);

    /// A venue's own executive for the prime computer; copies of this share it, so that only one of them may be stepped
    /// at a time. None: the deterministic one.
    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner) { runner_ = std::move(runner); }

    /// One cycle of both. `in` is completed with what only the computers give each other.
    void step(flight::DeviceInputs& in);
    /// Ticks that passed in that cycle beyond its own, because prime's executive took so long by a clock that does not
    /// wait.
    int take_ticks_skipped() { return runner_ ? runner_->take_ticks_skipped() : 0; }
    /// Such a tick: the other computer has its cycle; of prime there are the commands that hold, what came for it is
    /// lost.
    void step_without_prime(flight::DeviceInputs& in);

    /// The test venue "all but GNC": both computers take what stands in for GNC as their own.
    const flight::gnc::Configuration& gnc_configuration();
    void replace_gnc(const flight::gnc::Output& told);

    /// A case of a campaign begins: what both computers believe is moved.
    void shift_navigation(const flight::NavigationShift& by);

    /// The commands of this cycle that go out on the buses; none when neither computer is in command.
    const flight::DeviceOutputs* commands() const { return commander_ == nobody ? nullptr : &out_[commander_]; }
    /// What the computer at `place` (0: A, 1: B) put out in this cycle.
    const flight::DeviceOutputs& outputs(std::size_t place) const { return out_[place]; }

    /// A fault: the designated prime computer loses all it knows and starts anew.
    void reset_prime(Sclk now) { computers_[prime()].reset(now); }

    /// Cycles of the one that has run longest; of the rest the sum over both.
    flight::Computer::Counters counters() const;

  private:
    static constexpr std::size_t nobody = 2;

    std::size_t prime() const { return prime_is_b_ ? 1 : 0; }
    void step(flight::DeviceInputs& in, bool with_prime);
    void choose_commander();

    std::array<flight::Computer, 2> computers_;
    std::array<flight::DeviceOutputs, 2> out_;
    flight::DeviceInputs beside_;  ///< of the computer that is not in command
    std::size_t commander_ = 0;
    flight::StateOctets restart_record_;
    std::shared_ptr<flight::CycleRunner> runner_;
    bool prime_is_b_ = false;
};

}  // namespace aeolis::simulation
