// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/client_process.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

// Many clients on loopback. They run in a process of their own, so that the server is not charged for their cost.
namespace aeolis::bench {

constexpr std::size_t latency_bins = 20'000;  ///< bins of 50 us: up to one second

/// Memory that the benchmark and the client process share.
struct SharedCounters {
    std::atomic<int> phase{0};          ///< odd: connect and read; even: close
    std::atomic<int> reached_phase{0};  ///< the last phase that the clients have reached
    std::atomic<std::uint16_t> port{0};
    std::atomic<std::uint64_t> messages{0};  ///< messages received with a time stamp, over all clients
    std::atomic<std::uint64_t> octets{0};
    std::atomic<std::uint64_t> lost_connections{0};  ///< connections that the other end closed or that failed
    std::array<std::atomic<std::uint32_t>, latency_bins> latencies{};
};

/// Begins the time stamp in a message. The time at which the message was made follows: ns of CLOCK_MONOTONIC, in 16
/// hexadecimal digits.
inline constexpr std::string_view time_stamp_prefix = "made=";
/// An unsolicited pong, which clients send because the server drops a client that stays silent.
inline constexpr std::string_view unsolicited_pong{"\x8A\x80\0\0\0\0", 6};
std::string time_stamp_now();

class LoopbackClients {
  public:
    struct Settings {
        std::size_t clients = 1000, stalled = 0;  ///< stalled: the last ones, which subscribe and never read
        bool websocket = true;                    ///< false: a plain socket that only reads
        std::vector<std::string> subscriptions;   ///< ClientMessages, given to the clients in turn
    };
    /// Forks the client process. Call before any thread starts. Raises the limit of open files to its maximum.
    LoopbackClients();
    ~LoopbackClients();

    void connect(std::uint16_t port, const Settings& settings);
    void close();

    void reset_counts();
    std::uint64_t messages() const { return counters_->messages; }
    std::uint64_t octets() const { return counters_->octets; }
    std::uint64_t lost_connections() const { return counters_->lost_connections; }
    double latency_ms(double quantile) const;

  private:
    Shared<SharedCounters> counters_;
    int pipe_ = -1;  ///< settings to the other process
    int process_ = -1;
};

}  // namespace aeolis::bench
