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

// Many clients on loopback, in a process of their own so that what they cost is not the server's.
namespace aeolis::bench {

constexpr std::size_t latency_bins = 20'000;  ///< of 50 us: up to one second

/// Shared by both processes.
struct Board {
    std::atomic<int> phase{0};    ///< odd: connect and read; even: close
    std::atomic<int> settled{0};  ///< the phase that the clients have reached
    std::atomic<std::uint16_t> port{0};
    std::atomic<std::uint64_t> messages{0};  ///< marks that came in, at all clients
    std::atomic<std::uint64_t> octets{0};
    std::atomic<std::uint64_t> broken{0};  ///< connections that ended by themselves
    std::array<std::atomic<std::uint32_t>, latency_bins> latencies{};
};

/// What a message carries: a mark, and when it was made (nanoseconds of CLOCK_MONOTONIC, 16 hexadecimal digits).
inline constexpr std::string_view mark = "made=";
/// A pong that nobody asked for: a client that says nothing at all is taken for dead.
inline constexpr std::string_view alive{"\x8A\x80\0\0\0\0", 6};
std::string mark_now();

class LoopbackClients {
  public:
    struct Settings {
        std::size_t clients = 1000, stalled = 0;  ///< stalled: the last of them subscribe and never read
        bool websocket = true;                    ///< else what comes is only read
        std::vector<std::string> subscriptions;   ///< ClientMessages; each client sends one, by turns
    };
    /// Before any thread is started. Raises the limit of open files as far as it goes.
    LoopbackClients();
    ~LoopbackClients();

    void connect(std::uint16_t port, const Settings& settings);
    void close();

    void forget();  ///< figures begin again
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
