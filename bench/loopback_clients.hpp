// SPDX-License-Identifier: Apache-2.0
#pragma once

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
struct Board {
    std::atomic<int> phase{0};    ///< odd: connect and read; even: close
    std::atomic<int> settled{0};  ///< the last phase that the clients have reached
    std::atomic<std::uint16_t> port{0};
    std::atomic<std::uint64_t> messages{0};  ///< messages received with a mark, over all clients
    std::atomic<std::uint64_t> octets{0};
    std::atomic<std::uint64_t> broken{0};  ///< connections that the other end closed or that failed
    std::array<std::atomic<std::uint32_t>, latency_bins> latencies{};
};

/// Begins the time stamp in a message. The time at which the message was made follows: ns of CLOCK_MONOTONIC, in 16
/// hexadecimal digits.
inline constexpr std::string_view mark = "made=";
/// An unsolicited pong, which clients send because the server drops a client that stays silent.
inline constexpr std::string_view alive{"\x8A\x80\0\0\0\0", 6};
std::string mark_now();

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

    void forget();  ///< resets the counts
    std::uint64_t messages() const { return board_->messages; }
    std::uint64_t octets() const { return board_->octets; }
    std::uint64_t broken() const { return board_->broken; }
    double latency_ms(double quantile) const;

  private:
    Board* board_;
    int pipe_ = -1;  ///< settings to the other process
    int process_ = -1;
};

}  // namespace aeolis::bench
