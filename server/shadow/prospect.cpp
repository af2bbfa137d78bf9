// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/prospect.hpp"

#include "server/campaign/case_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::server::shadow {
namespace {

using campaign::CaseResult;

constexpr const char* landed = "touchdown";
constexpr double tail = 0.005;  // of a 99 % interval, on each side
constexpr std::uint64_t landings_for_ellipse = 3;

/// P(at least `part` of `of`), each with probability `p`.
double at_least(std::uint64_t part, std::uint64_t of, double p) {
    if (part == 0) return 1.0;
    if (p <= 0.0) return 0.0;
    if (p >= 1.0) return 1.0;
    const auto n = static_cast<double>(of);
    double sum = 0.0;
    for (std::uint64_t i = part; i <= of; ++i) {
        const auto k = static_cast<double>(i);
        sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) +
                        (n - k) * std::log1p(-p));
    }
    return std::min(sum, 1.0);
}

/// The probability for which `rising(p)`, which rises with p, is `wanted`.
template <typename Rising>
double solve(const Rising& rising, double wanted) {
    constexpr int halvings = 60;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (rising(middle) < wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

template <typename Figure>
Values values_over(std::span<const CaseResult> cases, const Figure& figure) {
    std::vector<double> values;
    values.reserve(cases.size());
    for (const CaseResult& result : cases)
        if (const std::optional<double> value = figure(result)) values.push_back(*value);
    return values_of(std::move(values));
}

std::optional<double> least_margin_s(const CaseResult& result) {
    if (result.margins.empty()) return std::nullopt;
    return std::ranges::min(result.margins, {}, &TimelineMargin::margin_s).margin_s;
}

std::vector<EventTimes> times_of(std::span<const CaseResult> cases, double after_e_s) {
    std::map<std::string, std::vector<double>> times;
    for (const CaseResult& result : cases)
        for (const campaign::CaseEvent& event : result.events)
            if (event.e_s > after_e_s) times[event.name].push_back(event.e_s);
    std::vector<EventTimes> events;
    events.reserve(times.size());
    for (auto& [name, values] : times) events.push_back({name, values_of(std::move(values))});
    std::ranges::stable_sort(events, {}, [](const EventTimes& event) { return event.e_s.median; });
    return events;
}

/// The columns that limits bound.
campaign::CaseTable table_of(std::span<const CaseResult> cases) {
    campaign::CaseTable table;
    for (const char* name :
         {"limits_exceeded", "propellant_kg", "vertical_mps", "horizontal_mps", "tilt_deg", "heatshield_least_m",
          "backshell_least_m", "parachute_mach", "parachute_pressure_Pa", "least_margin_s"})
        table.columns.push_back({name, {}});
    for (const CaseResult& result : cases) {
        table.numbers.push_back(result.number);
        table.outcomes.push_back(result.outcome);
        const auto of_touchdown = [&](double simulation::TouchdownReport::* member) {
            return result.touchdown ? (*result.touchdown).*member : campaign::unknown;
        };
        const auto of_parachute = [&](double simulation::ParachuteReport::* member) {
            return result.parachute ? (*result.parachute).*member : campaign::unknown;
        };
        std::size_t column = 0;
        for (const double value : {static_cast<double>(result.limits_exceeded), result.propellant_kg,
                                   of_touchdown(&simulation::TouchdownReport::vertical_mps),
                                   of_touchdown(&simulation::TouchdownReport::horizontal_mps),
                                   of_touchdown(&simulation::TouchdownReport::tilt_deg),
                                   result.separation.heatshield_least_m.value_or(campaign::unknown),
                                   result.separation.backshell_least_m.value_or(campaign::unknown),
                                   of_parachute(&simulation::ParachuteReport::mach),
                                   of_parachute(&simulation::ParachuteReport::dynamic_pressure_Pa),
                                   least_margin_s(result).value_or(campaign::unknown)})
            table.columns[column++].values.push_back(value);
    }
    return table;
}

}  // namespace

bool within_limits(const CaseResult& result) {
    return result.outcome == landed && result.limits_exceeded == 0;
}

Proportion proportion(std::uint64_t part, std::uint64_t of) {
    Proportion all{part, of, 0.0, 1.0};
    if (of == 0) return all;
    if (part > 0) all.low = solve([&](double p) { return at_least(part, of, p); }, tail);
    if (part < of) all.high = solve([&](double p) { return at_least(part + 1, of, p); }, 1.0 - tail);
    return all;
}

Values values_of(std::vector<double> values) {
    Values all;
    all.count = values.size();
    if (values.empty()) return all;
    std::ranges::sort(values);
    const std::size_t n = values.size();
    all.least = values.front();
    all.most = values.back();
    all.median = 0.5 * (values[(n - 1) / 2] + values[n / 2]);
    const auto one_more = static_cast<double>(n + 1);
    all.between = 1.0 - 2.0 / one_more;
    if (n < values_for_99) return all;
    const auto k = static_cast<std::size_t>(tail * one_more);
    all.interval_99 = Values::Interval{values[k - 1], values[n - k]};
    return all;
}

Prospect prospect_of(std::span<const CaseResult> cases, const simulation::Limits& limits, double after_e_s) {
    Prospect prospect;
    prospect.cases = cases.size();
    campaign::PlaneMoments places;
    for (const CaseResult& result : cases) {
        ++prospect.outcomes[result.outcome];
        if (result.touchdown) places.add(result.east_m, result.north_m);
        if (!within_limits(result)) prospect.outside.push_back({result.number, result.outcome, result.reason});
    }
    prospect.within = proportion(static_cast<std::uint64_t>(std::ranges::count_if(cases, within_limits)), cases.size());
    prospect.events = times_of(cases, after_e_s);
    const auto of_touchdown = [&](const auto& figure) {
        return values_over(cases, [&](const CaseResult& result) {
            return result.touchdown ? std::optional<double>{figure(result)} : std::nullopt;
        });
    };
    prospect.miss_m = of_touchdown([](const CaseResult& result) { return result.touchdown->miss_m; });
    prospect.east_m = of_touchdown([](const CaseResult& result) { return result.east_m; });
    prospect.north_m = of_touchdown([](const CaseResult& result) { return result.north_m; });
    prospect.vertical_mps = of_touchdown([](const CaseResult& result) { return result.touchdown->vertical_mps; });
    prospect.horizontal_mps = of_touchdown([](const CaseResult& result) { return result.touchdown->horizontal_mps; });
    prospect.propellant_kg = values_over(cases, [](const CaseResult& result) {
        return result.outcome == landed ? std::optional{result.propellant_kg} : std::nullopt;
    });
    prospect.peak_deceleration_mps2 =
        values_over(cases, [](const CaseResult& result) { return std::optional{result.peak_deceleration_mps2}; });
    prospect.least_margin_s = values_over(cases, least_margin_s);
    if (places.count() >= landings_for_ellipse) prospect.ellipse_99 = places.ellipse_99();
    prospect.limits = campaign::verdict_of(table_of(cases), limits).limits;
    return prospect;
}

Pairs pairs_of(std::span<const CaseResult> without, std::span<const CaseResult> with) {
    Pairs pairs;
    std::vector<double> miss_m, propellant_kg;
    for (std::size_t i = 0; i < std::min(without.size(), with.size()); ++i) {
        const bool before = within_limits(without[i]), after = within_limits(with[i]);
        ++(before ? (after ? pairs.within_both : pairs.only_without)
                  : (after ? pairs.only_with : pairs.within_neither));
        if (without[i].outcome != landed || with[i].outcome != landed) continue;
        miss_m.push_back(with[i].touchdown->miss_m - without[i].touchdown->miss_m);
        propellant_kg.push_back(with[i].propellant_kg - without[i].propellant_kg);
    }
    pairs.miss_change_m = values_of(std::move(miss_m));
    pairs.propellant_change_kg = values_of(std::move(propellant_kg));
    return pairs;
}

}  // namespace aeolis::server::shadow
