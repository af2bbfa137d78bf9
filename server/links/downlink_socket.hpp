// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/links/downlink_address.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::server {

/// A socket to receive by, and a way to wake who waits for it. One thread owns it; only wake() may come from others.
class DownlinkSocket {
  public:
    DownlinkSocket();
    ~DownlinkSocket();
    DownlinkSocket(const DownlinkSocket&) = delete;
    DownlinkSocket& operator=(const DownlinkSocket&) = delete;

    /// TCP: connects, within `limit`. UDP: binds. What was open is closed first.
    Result<void> open(const DownlinkAddress& address, std::chrono::milliseconds limit);
    void close();
    std::uint16_t local_port() const;

    enum class Got : std::uint8_t { octets, nothing, end, woken };
    struct Received {
        Got got = Got::nothing;
        std::size_t octets = 0;  ///< of `into`
        std::string reason;      ///< of the end
    };
    /// Waits until something comes, `limit` has passed, or wake() was called. Of a datagram what `into` has no room for
    /// is lost.
    Received receive(std::span<std::uint8_t> into, std::chrono::milliseconds limit);
    /// Waits; true when wake() was called.
    bool sleep(std::chrono::milliseconds time) const;
    /// From now on nothing waits any more.
    void wake() const;

  private:
    int socket_ = -1;
    int wake_ = -1;  ///< an event counter
};

}  // namespace aeolis::server
