// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/client_process.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aeolis::bench {

/// Programs that ask for lists over HTTP at the same time. They run in a process of their own, so that the server is
/// not charged for their memory and time.
class ListReaders {
  public:
    /// Chosen: fewer than the connections that the server takes besides streams. A closing one still counts for a
    /// moment.
    static constexpr std::size_t readers = 48;
    /// Forks the process of the readers; call before any thread starts. Each reader asks for every target once, one
    /// after another, and begins with a different one.
    explicit ListReaders(std::vector<std::string> targets);
    ~ListReaders();

    /// @param tokens  of programs, given to the readers in turn
    void begin(std::uint16_t port, const std::vector<std::string>& tokens);
    bool over() const { return counters_->over == readers; }

    std::uint64_t answers() const { return counters_->answers; }
    std::uint64_t refused() const { return counters_->refused; }  ///< answers other than 200
    std::uint64_t octets() const { return counters_->octets; }
    double longest_ms() const { return static_cast<double>(counters_->longest_us) * 1e-3; }

  private:
    struct SharedCounters {
        std::atomic<std::uint16_t> port{0};
        std::atomic<std::size_t> over{0};
        std::atomic<std::uint64_t> answers{0}, refused{0}, octets{0}, longest_us{0};
        std::array<std::array<char, 128>, readers> tokens{};
    };
    static void read_lists(SharedCounters& counters, std::size_t reader, const std::vector<std::string>& targets);

    Shared<SharedCounters> counters_;
    int process_ = -1;
};

}  // namespace aeolis::bench
