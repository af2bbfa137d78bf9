// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::tests {

/// A network that a test slows down and cuts: a port of loopback before another one.
class TcpProxy {
  public:
    explicit TcpProxy(std::uint16_t to);
    ~TcpProxy();

    std::string url() const;  ///< nats://…
    /// At most so many octets a second in each direction; 0: as many as come.
    void throttle(std::size_t octets_per_s) { octets_per_s_ = octets_per_s; }
    /// Closes all connections, and accepts none until join().
    void cut() { cut_ = true; }
    void join() { cut_ = false; }
    /// Nothing passes, and no connection is closed, until it is told otherwise.
    void hold(bool held) { held_ = held; }

  private:
    struct Way;
    struct Pair;
    void run();

    const std::uint16_t to_;
    int listens_ = -1;
    std::uint16_t port_ = 0;
    std::atomic<std::size_t> octets_per_s_{0};
    std::atomic<bool> cut_{false}, held_{false}, stop_{false};
    std::thread thread_;
};

}  // namespace aeolis::tests
