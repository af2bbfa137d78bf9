// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <poll.h>

namespace aeolis::server::net {

/// The connections whose request is being answered, so that work can stop when the client disconnects.
///
/// Rule     poll_peers() asks each socket whether the peer has closed its side; the peer's last octets, even TLS's
///          close, may be unread
/// Faults   a silent network goes unnoticed; a query's own time-out bounds that
/// Thread   the network thread, except for the function that disconnected() returns
class WaitingPeers {
    struct Peer {
        int descriptor = -1;
        std::shared_ptr<std::atomic<bool>> disconnected;
    };

  public:
    /// Registers one connection during its lifetime.
    class Waiting {
      public:
        Waiting(WaitingPeers& all, int descriptor)
            : all_(all),
              place_(all.peers_.insert(all.peers_.end(), {descriptor, std::make_shared<std::atomic<bool>>(false)})) {}
        ~Waiting() { all_.peers_.erase(place_); }
        Waiting(const Waiting&) = delete;
        Waiting& operator=(const Waiting&) = delete;
        /// A function that tells, on any thread, whether the client has disconnected; it may outlive this.
        std::function<bool()> disconnected() const {
            return [disconnected = place_->disconnected] { return disconnected->load(std::memory_order_relaxed); };
        }

      private:
        WaitingPeers& all_;
        std::list<Peer>::iterator place_;
    };

    void poll_peers() {
        for (const auto& peer : peers_) {
            pollfd polled{peer.descriptor, POLLRDHUP, 0};
            // POLLERR and POLLHUP are reported without being requested.
            if (::poll(&polled, 1, 0) > 0) peer.disconnected->store(true, std::memory_order_relaxed);
        }
    }

  private:
    std::list<Peer> peers_;
};

}  // namespace aeolis::server::net
