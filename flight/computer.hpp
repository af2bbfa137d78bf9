// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/kernel/cycle_runner.hpp"
#include "flight/load.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace aeolis::flight {

struct ComputerState;
namespace gnc {
struct Configuration;
struct Output;
}  // namespace gnc

/// Time from a reset until the software runs again; our assumption.
inline constexpr double restart_s = 30.0;

/// A flight computer: all of its state in one object of fixed size, created before the first tick.
///
/// In       DeviceInputs, one for each 1/64 s            Out   DeviceOutputs of that cycle
/// Memory   allocated on construction and copying, never in step()
/// Faults   a failed check inside step() is a FATAL event and a reset of this computer; step() itself never throws
/// Roles    R1: prime, or Second Chance as backup, as the vehicle's latch selects; a change of the latch restarts it
/// Harm     outputs of a computer that is not in command reach no device. R34
/// Copying a computer is a snapshot: two copies given the same inputs stay bit-identical.
class Computer {
  public:
    explicit Computer(const Load& load, Sclk start);
    Computer(const Computer& other);
    Computer& operator=(const Computer& other);
    Computer(Computer&&) noexcept;
    Computer& operator=(Computer&&) noexcept;
    ~Computer();

    /// Runs one 64 Hz cycle, with the deterministic executive unless a venue provides another `runner`.
    /// On entry `out` holds the commands of the previous cycle; they are cleared here.
    void step(const DeviceInputs& in, DeviceOutputs& out, CycleRunner* runner = nullptr);

    /// Loses its whole state and restarts, as after a power failure; used by injected faults.
    void reset(Sclk now);

    /// For the test venue "all but GNC", whose substitute for GNC reads the timeline's progress here. R36
    const gnc::Configuration& gnc_configuration() const;
    /// Replaces GNC's output in the next step by `told`. R36
    void replace_gnc(const gnc::Output& told);

    /// Shifts this computer's navigation state at the start of a campaign case.
    void shift_navigation(const NavigationShift& by);

    /// Makes this computer go on, with its next step, from the state that another one told on the line between them in
    /// the cycle before. For simulations that begin in mid-flight. False when the octets are no state of this build.
    bool resume(std::span<const std::uint8_t> state_frame);

    /// Whether ground has enabled this computer to take over as Second Chance.
    bool may_take_over() const;
    /// From here on tells the other computer no state, for simulations in which it is off.
    void tell_no_state();

    /// The whole state, for injected faults (flight/computer_state.hpp).
    ComputerState& state() { return *state_; }

    /// Counts kept by the executive, for reports and tests.
    struct Counters {
        std::uint64_t cycles = 0;
        std::uint64_t overruns = 0;
        std::uint64_t mailbox_overflows = 0;
        std::uint64_t unexpected_messages = 0;
        std::uint32_t resets = 0;
    };
    Counters counters() const;

  private:
    void start_anew(Sclk now, Role role, Sclk told_until);

    std::unique_ptr<ComputerState> state_;
};

}  // namespace aeolis::flight
