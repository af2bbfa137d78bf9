// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

/// Chosen, as the tone receiver has it: the least likelihood of a tone that something is concluded from.
inline constexpr double tone_believed = 0.9;

/// Follows a timeline from Earth: which timepoints are known to have fired, which comes next, and when, as predicted.
///
/// In       firings by packet; tones that only one timepoint requests
/// Rule     Packets move the prediction. A tone does not: it tells a timepoint only to within its symbol
/// Memory   a row a timepoint
class TimelineWatch {
  public:
    explicit TimelineWatch(const dictionary::Dictionary& dictionary);

    struct Known {
        double e_s = 0.0;  ///< when it was triggered
        bool by_tone = false, recorded = false;
        std::uint64_t seq = 0;
        double likelihood = 1.0;  ///< of the tone, where it is known by one
    };
    void fired(TimepointId timepoint, double triggered_e_s, double fired_e_s, bool recorded, std::uint64_t seq);
    /// Returns the timepoint that the tone reports; none if it reports none or a known one.
    std::optional<TimepointId> tone(ToneId tone, double likelihood, double e_s, std::uint64_t seq);

    const std::optional<Known>& known(std::size_t timepoint) const { return known_[timepoint]; }
    /// The last one known, in the timeline's order; none before the first.
    std::optional<std::size_t> last() const;
    /// The first unknown timepoint after the last known one whose tone has at least this priority.
    std::optional<std::size_t> next(int priority = 0) const;
    /// When it fires, in seconds from entry, as predicted; none: not predicted.
    MaybeOffset predicted_e_s(std::size_t timepoint) const { return predicted_e_s_[timepoint]; }
    /// The same as it was predicted before the landing.
    MaybeOffset foreseen_e_s(std::size_t timepoint) const { return foreseen_e_s_[timepoint]; }
    /// Whether the plan alone, and nothing in flight, gives its time.
    bool is_planned(std::size_t timepoint) const { return planned_e_s_[timepoint].has_value(); }
    std::optional<std::size_t> row_of(std::string_view name) const;

  private:
    void predict();

    const dictionary::Dictionary* dictionary_;
    std::vector<std::optional<Known>> known_;
    std::vector<std::optional<double>> fired_e_s_;  ///< by packet
    std::vector<std::optional<double>> triggered_e_s_;
    std::vector<MaybeOffset> predicted_e_s_, foreseen_e_s_, planned_e_s_;
    std::vector<std::optional<TimepointId>> of_tone_;  ///< by tone: the only timepoint that requests it
};

}  // namespace aeolis::telemetry
