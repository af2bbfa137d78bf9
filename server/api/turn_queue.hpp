// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace aeolis::server {

/// Jobs that are served in turn by client: each client's in the order received, one client after another.
///
/// Bounds   each_max jobs of one client and all_max of all wait, so that places remain for others. The client without a
///          name is the server itself, which has only the bound of all
/// Threads  none of its own: the caller locks
template <typename Job>
class TurnQueue {
  public:
    TurnQueue(std::size_t all_max, std::size_t each_max) : all_max_(all_max), each_max_(each_max) {}

    /// False, and not queued, when the client or all together have too many waiting.
    bool push(const std::string& client, Job job) {
        if (size_ >= all_max_) return false;
        const auto found = jobs_.find(client);
        if (!client.empty() && found != jobs_.end() && found->second.size() >= each_max_) return false;
        if (found == jobs_.end()) turns_.push_back(client);
        jobs_[client].push_back(std::move(job));
        ++size_;
        return true;
    }
    /// The next job of a client that `may` be served.
    template <typename Predicate>
    std::optional<Job> pop(const Predicate& may) {
        const auto turn = std::ranges::find_if(turns_, may);
        if (turn == turns_.end()) return std::nullopt;
        const std::string client = std::move(*turn);
        turns_.erase(turn);
        const auto found = jobs_.find(client);
        std::optional<Job> job{std::move(found->second.front())};
        found->second.pop_front();
        if (found->second.empty())
            jobs_.erase(found);
        else
            turns_.push_back(client);
        --size_;
        return job;
    }
    template <typename Predicate>
    bool has(const Predicate& may) const {
        return std::ranges::any_of(turns_, may);
    }
    std::size_t size() const { return size_; }
    /// The clients with jobs, the next one first.
    const std::deque<std::string>& clients() const { return turns_; }

  private:
    std::size_t all_max_, each_max_;
    std::size_t size_ = 0;
    std::map<std::string, std::deque<Job>> jobs_;  ///< by client; none is empty
    std::deque<std::string> turns_;                ///< the clients with jobs, the next one first
};

}  // namespace aeolis::server
