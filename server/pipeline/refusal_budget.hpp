// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace aeolis::server {

/// Limits a person's refusals in the audit: enough to show what they try, too few to fill it.
class RefusalBudget {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr unsigned each_minute = 60;  ///< chosen

    /// Counts a refusal of `who`. @return the number left out before it; none: this one is left out too
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
        std::optional<Clock::time_point> begun{};  ///< none: before the first refusal
        unsigned noted = 0;
        std::uint64_t left_out = 0;
    };
    std::map<std::string, Minute> minutes_;  ///< by user or token; bounded by those of the accounts file
};

}  // namespace aeolis::server
