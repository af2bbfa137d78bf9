// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>

// Requests of people at a follower, which its key signs and its origin checks. docs/decisions/0044.
namespace aeolis::server::cluster {

inline constexpr std::size_t request_number_octets = 16;  ///< chosen: never drawn twice

/// Reads the seed of a follower's key from a file that nobody else may read. The Error names the file.
Result<std::string> read_seed(const std::filesystem::path& file);
/// Makes a key: writes its seed into a new file that is its owner's alone. @return the public key, hexadecimal
Result<std::string> make_key(const std::filesystem::path& file);

/// The request with its signature, as it travels.
std::string signed_message(const v1::FollowerRequest& request, const std::string& seed);

/// Decides which requests an origin takes. One thread owns it.
///
/// In       messages as they came
/// Out      the request and the follower's public key, once each; else an Error that says why not
/// Memory   the numbers of the requests of the last minute, `kept_max` at most
class RequestCheck {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kept_for{60};  ///< longer than what an origin told of itself counts
    static constexpr std::size_t kept_max = 4096;        ///< chosen: more than a site commands in that time

    struct Rules {
        std::string origin;  ///< identity of the archive here
        /// The name of the follower with this public key (hexadecimal); none: it is not one, or no longer.
        std::function<std::optional<std::string>(const std::string& key)> follower;
        /// How long ago this origin said that; none: too long ago, or another process of it.
        std::function<std::optional<std::chrono::milliseconds>(const std::string& publisher, std::uint64_t count)> said;
    };
    explicit RequestCheck(Rules rules) : rules_(std::move(rules)) {}

    struct Taken {
        v1::FollowerRequest request;
        std::string key, follower;  ///< its public key, hexadecimal, and its name
    };
    Result<Taken> take(const std::string& octets, Clock::time_point now);

  private:
    Rules rules_;
    std::set<std::string> numbers_;
    std::deque<std::pair<Clock::time_point, std::string>> kept_;  ///< the oldest first
};

}  // namespace aeolis::server::cluster
