// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace aeolis::simulation {

/// The vehicle's two flight computers, and what connects them.
///
/// That is the latch that designates prime, the line between them, the memory that keeps a state over a restart, and
/// the bus, which obeys one of them.
///
/// In       the inputs of the computer in command, by tick; both receive the clock, the IMU's own link and the uplink
/// Out      the commands that the bus takes, and the recordings and radiation of both computers
/// Faults   when neither is in command nobody runs the buses; simulation/buses says what devices do then
///
/// Copying it forks it, like the rest of the vehicle.
class Computers {
  public:
    Computers(const flight::Load& load, Sclk start);

    /// Sets a venue's executive for the prime computer; null: the deterministic one. Copies of this object share the
    /// executive, so that only one of them may be stepped at a time.
    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner) { runner_ = std::move(runner); }

    /// Runs one cycle of both computers. Adds to `in` what the computers give each other.
    void step(flight::DeviceInputs& in);
    /// Ticks lost beyond that cycle's own, because prime's executive overran a clock that does not wait.
    int take_ticks_skipped() { return runner_ ? runner_->take_ticks_skipped() : 0; }
    /// Runs such a lost tick: the other computer has its cycle; prime's last commands hold, and its inputs are lost.
    void step_without_prime(flight::DeviceInputs& in);

    /// For the test venue "all but GNC": both computers take the stand-in's output as their own GNC's.
    const flight::gnc::Configuration& gnc_configuration();
    void replace_gnc(const flight::gnc::Output& told);

    /// Starts a campaign case: shifts the navigation state of both computers.
    void shift_navigation(const flight::NavigationShift& by);

    /// Makes prime go on from the state frame that another told in the cycle before. False when it is no state frame.
    bool place(std::span<const std::uint8_t> state_frame) { return computers_[prime()].resume(state_frame); }
    /// Prime's state frame of the last cycle; empty: it told none.
    std::span<const std::uint8_t> state_frame() const { return out_[prime()].cross_string.span(); }

    /// Turns the backup off if ground has not enabled it. It would only listen, so prime flies the same. After
    /// cruise-stage separation: before, the state that prime tells is also that of its own restart.
    void leave_idle_backup();

    /// The commands of this cycle for the buses; null when neither computer is in command.
    const flight::DeviceOutputs* commands() const { return commander_ == nobody ? nullptr : &out_[commander_]; }
    /// The outputs of the computer at `place` (0: A, 1: B) in this cycle.
    const flight::DeviceOutputs& outputs(std::size_t place) const { return out_[place]; }

    /// Injects a fault: the designated prime computer loses its state and restarts.
    void reset_prime(Sclk now) { computers_[prime()].reset(now); }

    /// Cycles of the longest-running computer; the other counts are sums over both.
    flight::Computer::Counters counters() const;

  private:
    static constexpr std::size_t nobody = 2;

    std::size_t prime() const { return prime_is_b_ ? 1 : 0; }
    void step(flight::DeviceInputs& in, bool with_prime);
    void choose_commander();

    std::array<flight::Computer, 2> computers_;
    std::array<flight::DeviceOutputs, 2> out_;
    flight::DeviceInputs beside_;  ///< inputs of the computer that is not in command
    std::size_t commander_ = 0;
    flight::StateOctets restart_record_;
    std::shared_ptr<flight::CycleRunner> runner_;
    bool prime_is_b_ = false;
    bool backup_off_ = false;
};

}  // namespace aeolis::simulation
