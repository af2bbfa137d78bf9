// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/links/downlink_address.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::server {

/// A receiving socket, and a way to wake its waiting thread. One thread owns it; only wake() may be called by others.
class DownlinkSocket {
  public:
    DownlinkSocket();
    ~DownlinkSocket();
    DownlinkSocket(const DownlinkSocket&) = delete;
    DownlinkSocket& operator=(const DownlinkSocket&) = delete;

    /// Opens the socket, closing an open one. TCP: connects within `limit`. UDP: binds.
    Result<void> open(const DownlinkAddress& address, std::chrono::milliseconds limit);
    void close();
    std::uint16_t local_port() const;

    enum class Got : std::uint8_t { octets, nothing, end, woken };
    struct Received {
        Got got = Got::nothing;
        std::size_t octets = 0;  ///< of `into`
        std::string reason;      ///< why the stream ended
    };
    /// Waits until octets arrive, `limit` has passed, or wake() was called. The part of a datagram beyond `into` is
    /// lost.
    Received receive(std::span<std::uint8_t> into, std::chrono::milliseconds limit);
    /// Waits for `time`; true when wake() was called.
    bool sleep(std::chrono::milliseconds time) const;
    /// Ends every present and future wait.
    void wake() const;

  private:
    int socket_ = -1;
    int wake_ = -1;  ///< an eventfd
};

}  // namespace aeolis::server
