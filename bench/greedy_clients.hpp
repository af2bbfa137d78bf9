// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/client_process.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace aeolis::bench {

/// Two clients that take all they can get: one asks 60 slow questions at a time, one sends 1000 commands a second. They
/// run in a process of their own, so that the server is not charged for their memory and time.
class GreedyClients {
  public:
    static constexpr std::size_t questions_at_once = 60, commands_per_s = 1000;

    /// Forks their process; call before any thread starts.
    GreedyClients();
    ~GreedyClients();

    struct Targets {
        std::string question, asker;      ///< a path of the API, and the token of who asks for it
        std::string commands, commander;  ///< where commands are posted, and the token of who does
    };
    void begin(std::uint16_t port, const Targets& targets);

    std::uint64_t answers() const { return counters_->answers; }  ///< to questions, with 200
    std::uint64_t refused() const { return counters_->refused; }  ///< questions
    std::uint64_t commands() const { return counters_->commands; }
    std::uint64_t limited() const { return counters_->limited; }  ///< commands that got 429

  private:
    using Text = std::array<char, 256>;
    struct SharedCounters {
        std::atomic<std::uint16_t> port{0};
        std::atomic<std::uint64_t> answers{0}, refused{0}, commands{0}, limited{0};
        Text question{}, asker{}, target{}, commander{};
    };
    static void ask(SharedCounters& counters);
    static void command(SharedCounters& counters);

    Shared<SharedCounters> counters_;
    int process_ = -1;
};

}  // namespace aeolis::bench
