// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"

#include <cstdint>

namespace aeolis::simulation {

/// A command on its way to a remote terminal.
struct BusCommand {
    enum class Kind : std::uint8_t { pyro, device_switch, thrusters };
    flight::Device device{};  ///< the device addressed, with its unit
    flight::Unit unit{};
    Kind kind{};
    flight::PyroId pyro{};
    flight::SwitchId switch_id{};
    flight::Unit switched{};  ///< the unit to power or switch off
    bool on = false;
    std::uint8_t tries = 0;
};

/// One MIL-STD-1553 bus with its controller: a frame every 1/64 s or 1/8 s, its messages in sequence.
///
/// In       commands at any time; they wait for the next frame, in order
/// Errors   each message is garbled with a seeded probability. The controller repeats a garbled message once in its
///          frame. A command that still fails, or that its terminal does not answer, is tried in three frames (our
///          assumption) and given up. Only a requester that waits for a reply notices
/// Memory   a queue of 32 commands; at most 24 messages a frame, the rest waits (our assumption: a 1553 bus carries
///          about 20 messages of 32 words in 1/64 s, and these have a few words)
/// Model    no words and no microseconds: a message that gets through does so at the tick on which its frame begins
class Bus {
  public:
    Bus(std::int64_t frame_ticks, double message_error_fraction, Random random)
        : frame_ticks_(frame_ticks), message_error_fraction_(message_error_fraction), random_(random) {}

    bool frame_begins(std::int64_t tick) const { return tick % frame_ticks_ == 0; }
    /// Queues a command for the next frame. Without room it is lost and counted.
    void queue(const BusCommand& command) {
        if (!waiting_.try_push_back(command)) ++counters_.given_up;
    }

    /// Sends the frame's commands; `execute(command)` says whether the terminal answered.
    template <typename Execute>
    void send(const Execute& execute) {
        unsigned held_up = 0;  // units whose earlier command has to come first
        std::size_t kept = 0;
        for (std::size_t i = 0; i < waiting_.size(); ++i) {
            BusCommand command = waiting_[i];
            const unsigned unit =
                1U << (2 * static_cast<unsigned>(command.device) + static_cast<unsigned>(command.unit));
            if ((held_up & unit) == 0 && i < messages_per_frame_max && exchange() && execute(command)) continue;
            if ((held_up & unit) == 0 && i < messages_per_frame_max && ++command.tries == tries_max) {
                ++counters_.given_up;
                continue;
            }
            held_up |= unit;
            waiting_[kept++] = command;
        }
        while (waiting_.size() > kept) waiting_.erase_at(waiting_.size() - 1);
    }

    /// Exchanges one message, with its repetition; returns whether it got through.
    bool exchange() {
        ++counters_.messages;
        if (!garbled()) return true;
        ++counters_.repeated;
        if (!garbled()) return true;
        ++counters_.failed;
        return false;
    }

    /// Draws from `random` from here on.
    void disperse(Random random) { random_ = random; }

    struct Counters {
        std::uint64_t messages = 0;
        std::uint64_t repeated = 0;  ///< garbled once
        std::uint64_t failed = 0;    ///< garbled twice in a frame
        std::uint64_t given_up = 0;  ///< commands that will not be carried out
    };
    const Counters& counters() const { return counters_; }

  private:
    bool garbled() { return message_error_fraction_ > 0.0 && random_.uniform() < message_error_fraction_; }

    static constexpr std::size_t messages_per_frame_max = 24;
    static constexpr std::uint8_t tries_max = 3;

    std::int64_t frame_ticks_;
    double message_error_fraction_;
    Random random_;
    FixedVector<BusCommand, 32> waiting_;
    Counters counters_;
};

}  // namespace aeolis::simulation
