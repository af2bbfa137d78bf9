// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace aeolis::server {

/// Limits how often each client sends commands, including dry runs: a number at once, and a lasting rate.
///
/// Memory   clients_max clients; those that have sent nothing for long are forgotten, and more than that share one
///          allowance
/// Thread   the network thread
class CommandRates {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr double each_second = 100.0;        ///< chosen: ten times what a console's controls can ask
    static constexpr double at_once = 2'500.0;          ///< chosen: more than one may have under way: commands/shares
    static constexpr std::size_t clients_max = 10'000;  ///< chosen

    /// Counts `commands` of a client. @return none when they may be sent; else the time until that many may be
    std::optional<std::chrono::seconds> take(const std::string& client, std::size_t commands, Clock::time_point now);

  private:
    struct Allowance {
        double left = at_once;
        Clock::time_point at{};
    };
    static double left_at(const Allowance& allowance, Clock::time_point now);

    std::map<std::string, Allowance> clients_;
};

}  // namespace aeolis::server
