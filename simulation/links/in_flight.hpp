// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace aeolis::simulation {

/// Items on their way between the planets, in the order of sending, each with its time of arrival. All travel equally
/// long, so the order of arrival is the order of sending.
template <typename T>
class InFlight {
  public:
    void send(std::int64_t arrives_us, T what) { queue_.emplace_back(arrives_us, std::move(what)); }
    bool empty() const { return queue_.empty(); }

    /// Hands over all items that have arrived by `now_us`.
    template <typename Receive>
    void arrive(std::int64_t now_us, Receive&& receive) {
        while (!queue_.empty() && queue_.front().first <= now_us) {
            receive(queue_.front().first, std::move(queue_.front().second));
            queue_.pop_front();
        }
    }

  private:
    std::deque<std::pair<std::int64_t, T>> queue_;
};

}  // namespace aeolis::simulation
