// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/cross_string/state_frame.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Silence after which prime counts as failed.
/// Chosen: well above the one or two cycles of an overrun, well below the second in which Second Chance must fly.
inline constexpr double prime_silent_s = 0.25;

/// Longest time between two states stored for a restart.
/// Chosen: attitude is then as good as the rates of a second, and memory is written 64 times less often than the line.
inline constexpr double keep_every_s = 1.0;

/// Oldest state from which Second Chance takes over: Edl keeps one second of IMU readings.
inline constexpr double state_age_max_s = 0.9;

/// The line between the computers: prime sends its state, Second Chance listens and may take over.
///
/// In      StatePart from edl (prime) or from the line (Second Chance), StoredStatePart, ClockTick,
///         EnableSecondChanceCommand, SelectPrimeCommand, ResumePrimeCommand, OtherRunsBuses, EdlFinished
/// Out     prime: the state on the line each cycle, and stored for a restart when its revision has changed, else each
///         second; after a restart, Resume and the stored state to edl. Second Chance: the same when it takes over; the
///         units that prime addresses, to units; SecondChanceStatus; CommandOutcome
/// Rule    Second Chance takes over when ground has enabled it, prime's line has been silent for 0.25 s, and prime's
///         last state is less than 0.9 s old and says that EDL had begun, the cruise stage was gone and touchdown was
///         still to come. Anything received on the line, readable or not, counts as a sign of life: in doubt it does
///         nothing. Touchdown turns it off permanently. R1, R33, R34
///         A prime that stands by is not ordered on while the other computer runs the buses. R32, R34
class CrossString {
  public:
    explicit CrossString(const Load& load) : load_role_(load.role) {}

    void on(const StatePart& part, Outbox& out);
    void on(const StoredStatePart& stored, Outbox& out);
    void on(const EnableSecondChanceCommand& command, Outbox& out);
    void on(const SelectPrimeCommand& command, Outbox& out);
    void on(const ResumePrimeCommand& command, Outbox& out);
    void on(const OtherRunsBuses& seen, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);
    /// Second Chance has landed the vehicle: it turns off.
    void on(const EdlFinished& finished, Outbox& out);

    /// Whether this computer is in control as Second Chance, so that the bus may listen to it.
    bool in_control() const { return in_control_ && !off_; }
    /// Whether ground has enabled it to take over.
    bool enabled() const { return enabled_; }

  private:
    static void put(StateOctets& line, std::span<const std::uint8_t> state);
    void tell(const StatePart& part, Outbox& out);
    void turn_off(Outbox& out);
    bool may_take_over(Sclk now, Outbox& out);

    Role load_role_;
    StateAssembly assembly_;
    StateFrame latest_;
    std::optional<Sclk> heard_;
    std::optional<Sclk> other_ran_buses_;  ///< seen so last
    std::uint32_t kept_revision_ = 0;
    Sclk kept_at_;
    std::optional<Sclk> designate_at_;
    bool designated_b_ = false;
    UnitSelection told_units_;
    bool enabled_ = false;
    bool too_old_told_ = false;
    bool in_control_ = false;
    bool off_ = false;
};

}  // namespace aeolis::flight
