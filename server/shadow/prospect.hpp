// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/campaign/case_result.hpp"
#include "server/campaign/limit_margins.hpp"
#include "server/campaign/statistics.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

// What flown cases say together, and how far so few of them can say it.
namespace aeolis::server::shadow {

/// Whether the case landed, and exceeded none of the scenario's limits.
bool within_limits(const campaign::CaseResult& result);

/// A part of cases, as an estimate of a probability: never a certainty, however many cases agree.
struct Proportion {
    std::uint64_t part = 0, of = 0;
    double low = 0.0, high = 1.0;  ///< of the 99 % confidence interval
};
/// With the exact interval of Clopper and Pearson, which holds the true probability in 99 % of experiments or more.
/// Source: [clopper-1934].
Proportion proportion(std::uint64_t part, std::uint64_t of);

/// The least number of values of which a 99 % interval of the next one can be told: (n − 1)/(n + 1) ≥ 0.99.
inline constexpr std::uint64_t values_for_99 = 199;

/// Values of one quantity over cases. Distribution-free: the next value lies between the kth least and the kth largest
/// of n with probability 1 − 2k/(n + 1). Source: [wilks-1941].
struct Values {
    std::uint64_t count = 0;
    double least = 0.0, median = 0.0, most = 0.0;
    double between = 0.0;  ///< probability that the next value lies between least and most
    struct Interval {
        double from = 0.0, to = 0.0;
    };
    std::optional<Interval> interval_99;  ///< none: too few values
};
Values values_of(std::vector<double> values);

struct EventTimes {
    std::string name;
    Values e_s;  ///< of the cases in which it happened; `count` of them did
};

/// What the cases of one side of a forecast say.
struct Prospect {
    std::uint64_t cases = 0;
    std::map<std::string, std::uint64_t> outcomes;
    Proportion within;  ///< landed within all of the scenario's limits
    struct Outside {
        std::uint64_t number = 0;
        std::string outcome, reason;
    };
    std::vector<Outside> outside;    ///< the other cases, and why
    std::vector<EventTimes> events;  ///< after the forecast's beginning, by median
    Values miss_m, east_m, north_m, vertical_mps, horizontal_mps, propellant_kg, peak_deceleration_mps2, least_margin_s;
    std::optional<campaign::Ellipse> ellipse_99;  ///< of the touchdowns, about the target; none: fewer than three
    std::vector<campaign::LimitMargin> limits;    ///< each with the case that comes nearest to it
};
/// @param after_e_s  events before are known already
Prospect prospect_of(std::span<const campaign::CaseResult> cases, const simulation::Limits& limits, double after_e_s);

/// The same cases with and without what is assumed, each pair with the same errors.
struct Pairs {
    std::uint64_t within_both = 0, only_without = 0, only_with = 0, within_neither = 0;
    Values miss_change_m, propellant_change_kg;  ///< with less without, of pairs in which both landed
};
Pairs pairs_of(std::span<const campaign::CaseResult> without, std::span<const campaign::CaseResult> with);

}  // namespace aeolis::server::shadow
