// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace aeolis::server {

/// How many refusals of one person the audit takes: enough to see what they try, too few to fill it by trying.
class RefusalBudget {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr unsigned each_minute = 60;  ///< ours

    /// One more refusal of `who`. @return how many before it are not noted; none: neither is this one
    std::optional<std::uint64_t> take(const std::string& who, Clock::time_point now) {
        auto& minute = minutes_[who];
        if (!minute.begun || now - *minute.begun >= std::chrono::minutes{1}) {
            minute.begun = now;
            minute.noted = 0;
        }
        if (minute.noted == each_minute) {
            ++minute.left_out;
            return std::nullopt;
        }
        ++minute.noted;
        return std::exchange(minute.left_out, 0U);
    }

  private:
    struct Minute {
        std::optional<Clock::time_point> begun{};  ///< none: it is their first
        unsigned noted = 0;
        std::uint64_t left_out = 0;
    };
    std::map<std::string, Minute>
        minutes_;  ///< by who: users and tokens there are, so no more than the file of accounts has had
};

}  // namespace aeolis::server
