// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <poll.h>

namespace aeolis::server::net {

/// Connections whose request is being answered, so that the work can stop when the client leaves.
///
/// Rule     look() asks each socket whether the peer has closed its side: what it sent before that, even TLS's own
///          farewell, may lie unread
/// Faults   a network that falls silent shows nothing; a question's own time-out bounds that
/// Thread   the network thread, but for what gone() returns
class WaitingPeers {
    struct Peer {
        int descriptor = -1;
        std::shared_ptr<std::atomic<bool>> gone;
    };

  public:
    /// Places one connection among them for as long as this lives.
    class Waiting {
      public:
        Waiting(WaitingPeers& all, int descriptor)
            : all_(all),
              place_(all.peers_.insert(all.peers_.end(), {descriptor, std::make_shared<std::atomic<bool>>(false)})) {}
        ~Waiting() { all_.peers_.erase(place_); }
        Waiting(const Waiting&) = delete;
        Waiting& operator=(const Waiting&) = delete;
        /// Tells from any thread whether the client has left, also when this lives no longer.
        std::function<bool()> gone() const {
            return [gone = place_->gone] { return gone->load(std::memory_order_relaxed); };
        }

      private:
        WaitingPeers& all_;
        std::list<Peer>::iterator place_;
    };

    void look() {
        for (const auto& peer : peers_) {
            pollfd polled{peer.descriptor, POLLRDHUP, 0};
            // POLLERR and POLLHUP are told without being asked for.
            if (::poll(&polled, 1, 0) > 0) peer.gone->store(true, std::memory_order_relaxed);
        }
    }

  private:
    std::list<Peer> peers_;
};

}  // namespace aeolis::server::net
