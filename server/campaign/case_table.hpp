// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::campaign {

/// The most cases that one table holds. Chosen: 30 MB of numbers, and twice the mission's own campaigns.
inline constexpr std::uint64_t table_cases_max = 20'000;

/// All numbers of a campaign's cases, a row a case and a column a quantity: what analysts plot, correlate and compare.
///
/// Columns: the figures of a case (miss_m, propellant_kg, …); `draw.NAME`, its seeded errors; `event.NAME.e_s`,
/// `.altitude_m`, `.speed_mps`, `.east_m` and `.north_m`; `margin.TIMEPOINT_s`. Not a number: the case has none.
struct CaseTable {
    struct Column {
        std::string name;
        std::vector<double> values;
    };
    std::vector<std::uint64_t> numbers;  ///< of the cases, ascending
    std::vector<std::string> outcomes;
    std::vector<Column> columns;

    /// Null: there is none of that name.
    const Column* column(std::string_view name) const;
};

/// CSV with a heading. What a case does not have is an empty cell.
std::string csv_of(const CaseTable& table);

/// How closely two quantities go together over the cases that have both.
struct Correlation {
    std::string figure, draw;
    double r = 0.0;      ///< Pearson's
    double slope = 0.0;  ///< figure's change by one standard deviation of the draw, in the figure's unit
    std::uint64_t cases = 0;
    /// |r| that chance alone exceeds in three cases of a thousand: 3/√n.
    double by_chance = 0.0;
};
/// The correlation of each draw with each of `figures`, the strongest first within a figure. A draw that does not vary
/// is left out.
std::vector<Correlation> correlations(const CaseTable& table, const std::vector<std::string>& figures);

/// A quantity in two campaigns.
struct Compared {
    std::string name;
    std::uint64_t cases_a = 0, cases_b = 0;
    double p1_a = 0.0, p50_a = 0.0, p99_a = 0.0, p1_b = 0.0, p50_b = 0.0, p99_b = 0.0;
    double mean_a = 0.0, mean_b = 0.0;
    double sigma_a = 0.0, sigma_b = 0.0;
    /// Difference of the means (B less A) over its own standard error; beyond 3 it is hardly chance.
    double difference_sigmas = 0.0;
};
/// Each quantity that both tables have, of A's order, without draws.
std::vector<Compared> compared(const CaseTable& a, const CaseTable& b);

}  // namespace aeolis::server::campaign
