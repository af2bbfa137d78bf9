// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/kernel/cycle_runner.hpp"
#include "flight/load.hpp"

#include <memory>

namespace aeolis::flight {

struct ComputerState;
namespace gnc {
struct Configuration;
struct Output;
}  // namespace gnc

/// Ours: from a reset until the software runs again.
inline constexpr double restart_s = 30.0;

/// A flight computer: all of its state in one object of fixed size, made before the first tick.
///
/// In       DeviceInputs, one for each 1/64 s            Out   DeviceOutputs of that cycle
/// Memory   allocated when made and when copied, never in step()
/// Faults   a failed check inside step() is a FATAL event and a reset of this computer; step() itself never throws
/// Roles    prime, or Second Chance behind it, as the vehicle's latch says; when the latch changes it starts anew. R1
/// Do no harm: whatever its modules put out, nothing of a computer that is not in command reaches a device. R34
/// Copying a computer is a snapshot: two copies fed the same inputs stay bit-identical.
class Computer {
  public:
    explicit Computer(const Load& load, Sclk start);
    Computer(const Computer& other);
    Computer& operator=(const Computer& other);
    Computer(Computer&&) noexcept;
    Computer& operator=(Computer&&) noexcept;
    ~Computer();

    /// Runs one 64 Hz cycle, by the deterministic executive unless a venue brings another. `out` holds the commands of
    /// the cycle before and is begun anew here.
    void step(const DeviceInputs& in, DeviceOutputs& out, CycleRunner* runner = nullptr);

    /// Loses all it knows and starts anew, as if the power had failed: what a fault injected from outside does.
    void reset(Sclk now);

    /// The test venue "all but GNC": what stands in for GNC looks at what the timeline has done, and what it tells
    /// counts as GNC's in the next step. R36
    const gnc::Configuration& gnc_configuration() const;
    void replace_gnc(const gnc::Output& told);

    /// A case of a campaign begins: what this computer's navigation believes is moved.
    void shift_navigation(const NavigationShift& by);

    /// What it holds, for faults that are put in from outside (flight/computer_state.hpp).
    ComputerState& state() { return *state_; }

    /// What the executive counted: for reports and tests.
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
