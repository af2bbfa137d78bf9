// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace aeolis::server::net {

/// Memory for response bodies that clients have not yet taken.
///
/// Rule     a short body always has room, however many long ones wait; so has a body that is alone
/// Thread   the network thread
class BodyBudget {
  public:
    static constexpr std::size_t short_octets = 512 << 10;  ///< chosen: the console's files, the dictionary

    explicit BodyBudget(std::size_t octets_max) : octets_max_(octets_max) {}

    /// Counts one body during its lifetime.
    class Share {
      public:
        Share(BodyBudget& budget, std::size_t octets) : budget_(budget), octets_(octets) { budget_.octets_ += octets_; }
        ~Share() { budget_.octets_ -= octets_; }
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;

      private:
        BodyBudget& budget_;
        std::size_t octets_;
    };
    bool has_room(std::size_t octets) const {
        return octets <= short_octets || octets_ == 0 || octets_ + octets <= octets_max_;
    }

  private:
    std::size_t octets_max_, octets_ = 0;
};

}  // namespace aeolis::server::net
