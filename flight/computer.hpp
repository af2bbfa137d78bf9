#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/load.hpp"

#include <memory>

namespace aeolis::flight {

struct ComputerState;

/// A flight computer: all of its state in one object of fixed size, made before the first tick.
///
/// In       DeviceInputs, one for each 1/64 s            Out   DeviceOutputs of that cycle
/// Memory   allocated when made and when copied, never in step()
/// Faults   a failed check inside step() is a FATAL event and a reset of this computer; step() itself never throws
/// Copying a computer is a snapshot: two copies fed the same inputs stay bit-identical.
class Computer {
  public:
    explicit Computer(const Load& load, Sclk start);
    Computer(const Computer& other);
    Computer& operator=(const Computer& other);
    Computer(Computer&&) noexcept;
    Computer& operator=(Computer&&) noexcept;
    ~Computer();

    /// Runs one 64 Hz cycle. `out` holds the commands of the cycle before and is begun anew here.
    void step(const DeviceInputs& in, DeviceOutputs& out);

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
    std::unique_ptr<ComputerState> state_;
};

}  // namespace aeolis::flight
