// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

// The two clocks of the machine: the system's, which tells UTC and can be set, and the monotonic one, which only
// counts. NTP slews both alike (clock_gettime(2)), so their difference changes only when the system's clock is set or
// the machine sleeps.
namespace aeolis::server {

struct ClockReading {
    std::int64_t system_us = 0;  ///< since 1970, UTC as the machine is set
    std::int64_t monotonic_us = 0;
    std::int64_t taken_us = 0;  ///< time to read both, and so their greatest skew
};
using ReadClocks = std::function<ClockReading()>;
ClockReading read_clocks();

/// The time on Earth of one run: the system's clock when the run began, and from there on the monotonic clock. It never
/// goes back, and differences of it are true, whatever happens to the system's clock. docs/decisions/0034
class EarthClock {
  public:
    explicit EarthClock(ReadClocks read = read_clocks) : read_(std::move(read)), began_(read_()) {}
    /// From any thread, if the readings are.
    Ert now() const;

  private:
    ReadClocks read_;
    ClockReading began_;
};

/// The system's clock has moved against the monotonic clock.
struct ClockJump {
    std::int64_t by_us = 0;      ///< negative: back
    std::int64_t system_us = 0;  ///< what the system's clock reads now
};
/// A sentence that gives the size of the jump, and the times before and after it.
std::string text_of(const ClockJump& jump);

/// Finds jumps of the system's clock, at each look.
class ClockWatch {
  public:
    static constexpr std::int64_t least_us = 500'000;    ///< chosen: far above the error of reading the clocks
    static constexpr std::int64_t blurred_us = 100'000;  ///< chosen: a reading that took longer shows nothing

    explicit ClockWatch(ReadClocks read = read_clocks);
    /// The jump since the last one returned, including small steps, which add up. None when it is less than `least_us`.
    std::optional<ClockJump> look();

    std::uint64_t jumps() const { return jumps_; }
    /// All jumps together: how far the system's clock has moved since the start.
    double moved_s() const { return static_cast<double>(moved_us_) * 1e-6; }

  private:
    ReadClocks read_;
    std::int64_t apart_us_ = 0;  ///< system's clock minus monotonic clock, as of the last jump returned
    std::int64_t moved_us_ = 0;
    std::uint64_t jumps_ = 0;
};

}  // namespace aeolis::server
