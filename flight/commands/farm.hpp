// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tc_frame.hpp"

#include <cstdint>

namespace aeolis::flight {

/// FARM-1: accepts telecommand frames of one virtual channel, and reports its state. [ccsds-232.1-b-2]
///
/// In      frames with a correct CRC                           Out   a verdict on each; the CLCW at any time
/// Rule    A frames are accepted in sequence only, none twice; B frames always. A frame whose sequence number is far
///         from the expected one locks the channel until ground unlocks it
/// Memory  this object. Accepted frames are passed on at once, so the wait flag is never raised
/// Faults  a frame for another spacecraft or channel, or an invalid control command, is refused and changes nothing
class Farm {
  public:
    static constexpr unsigned sequence_numbers = 256;

    /// `window`: even, 2 … 254. Half of it lies ahead of the expected sequence number, half behind.
    struct Settings {
        std::uint16_t spacecraft = 0;
        std::uint8_t virtual_channel = 0;
        std::uint8_t window = sequence_numbers / 2;
        /// Refuses sequenced frames until ground unlocks the channel.
        /// After losing the expected sequence number, FARM-1 could otherwise accept an old frame as new.
        bool locked_at_start = false;
    };

    enum class Verdict : std::uint8_t {
        accepted,         ///< data to be acted on
        executed,         ///< a control command, which FARM-1 has executed
        repeated,         ///< already accepted
        out_of_sequence,  ///< an earlier frame is missing: ground must retransmit from there
        locked_out,       ///< so far out of sequence that the channel is now locked, or it was locked already
        not_for_this_channel,
        no_such_control,
    };

    constexpr explicit Farm(const Settings& settings) : settings_(settings), lockout_(settings.locked_at_start) {
        AEOLIS_CHECK(settings.window >= 2 && settings.window <= 254 && settings.window % 2 == 0);
    }

    constexpr Verdict take(const TcFrame& frame) {
        if (frame.header.spacecraft != settings_.spacecraft ||
            frame.header.virtual_channel != settings_.virtual_channel)
            return Verdict::not_for_this_channel;
        if (frame.header.control) return frame.header.bypass ? execute(frame.data) : Verdict::no_such_control;
        if (frame.header.bypass) {
            farm_b_ = (farm_b_ + 1) & 3;
            return Verdict::accepted;
        }
        return take_in_sequence(frame.header.sequence);
    }

    constexpr Clcw clcw() const {
        return {.virtual_channel = settings_.virtual_channel,
                .lockout = lockout_,
                .retransmit = retransmit_,
                .farm_b = farm_b_,
                .expected = expected_};
    }

  private:
    constexpr Verdict take_in_sequence(std::uint8_t sequence) {
        if (lockout_) return Verdict::locked_out;
        const auto ahead = static_cast<std::uint8_t>(sequence - expected_);
        const unsigned half = settings_.window / 2U;
        if (ahead == 0) {
            ++expected_;
            retransmit_ = false;
            return Verdict::accepted;
        }
        if (ahead < half) {
            retransmit_ = true;
            return Verdict::out_of_sequence;
        }
        if (ahead >= sequence_numbers - half) return Verdict::repeated;
        lockout_ = true;
        return Verdict::locked_out;
    }

    /// Executes a control command. Unlock: 00. Set V(R): 82 00 and the sequence number.
    constexpr Verdict execute(std::span<const std::uint8_t> control) {
        const bool unlock = control.size() == 1 && control[0] == 0x00;
        const bool set = control.size() == 3 && control[0] == 0x82 && control[1] == 0x00;
        if (!unlock && !set) return Verdict::no_such_control;
        farm_b_ = (farm_b_ + 1) & 3;
        if (unlock) lockout_ = false;
        if (set && lockout_) return Verdict::locked_out;
        if (set) expected_ = control[2];
        retransmit_ = false;
        return Verdict::executed;
    }

    Settings settings_;
    std::uint8_t expected_ = 0;  ///< V(R)
    std::uint8_t farm_b_ = 0;
    bool lockout_;
    bool retransmit_ = false;
};

}  // namespace aeolis::flight
