// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace aeolis::telemetry {

/// Learns how often a followed link delivers, and detects by that measure when it is silent.
///
/// In       the times of reception, and the time now            Out   the silence, once it is one
/// Rule     silent after `silent_intervals` times the longest interval lately, at least `silent_least_us`; not before
///          `intervals_known` intervals were seen. An interval counts less with each later one, so that a faster rhythm
///          is learnt as well
class LinkRhythm {
  public:
    static constexpr unsigned intervals_known = 8;              ///< chosen
    static constexpr std::int64_t silent_intervals = 3;         ///< chosen, as for packets that are promised
    static constexpr std::int64_t silent_least_us = 3'000'000;  ///< chosen, likewise
    static constexpr unsigned silences_until_slower = 3;        ///< chosen
    static constexpr double fades = 0.98;                       ///< chosen: an interval's weight halves after 34 more

    void heard(Ert at) {
        if (last_ && at.microseconds > last_->microseconds) {
            const auto interval_us = static_cast<double>(at.microseconds - last_->microseconds);
            // A silence that was reported is not an interval of the rhythm, but several in a row are a new rhythm.
            silences_ = silent(at) ? silences_ + 1 : 0;
            if (silences_ == 0 || silences_ == silences_until_slower) {
                longest_us_ = std::max(interval_us, fades * longest_us_);
                ++intervals_;
                silences_ = 0;
            }
        }
        last_ = at;
    }

    struct Silence {
        Ert since;                ///< the last reception
        double interval_s = 0.0;  ///< the longest lately
    };
    std::optional<Silence> silent(Ert now) const {
        if (!last_ || intervals_ < intervals_known) return std::nullopt;
        const auto limit_us =
            std::max(static_cast<double>(silent_least_us), static_cast<double>(silent_intervals) * longest_us_);
        if (static_cast<double>(now.microseconds - last_->microseconds) <= limit_us) return std::nullopt;
        return Silence{*last_, longest_us_ * 1e-6};
    }

  private:
    std::optional<Ert> last_;
    double longest_us_ = 0.0;
    unsigned intervals_ = 0, silences_ = 0;
};

}  // namespace aeolis::telemetry
