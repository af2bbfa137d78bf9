// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/limit_margins.hpp"

#include "server/base/json_object.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server::campaign {
namespace {

using simulation::Limits;

/// A limit and the columns that it bounds: the worst of them counts.
struct LimitOf {
    const char* name;
    double Limits::* member;
    bool at_least;
    std::array<const char*, 2> columns;
};

constexpr std::array limits_of_columns{
    LimitOf{"propellant_left_min_kg", &Limits::propellant_left_min_kg, true, {"propellant_kg", nullptr}},
    LimitOf{"touchdown_vertical_max_mps", &Limits::touchdown_vertical_max_mps, false, {"vertical_mps", nullptr}},
    LimitOf{"touchdown_horizontal_max_mps", &Limits::touchdown_horizontal_max_mps, false, {"horizontal_mps", nullptr}},
    LimitOf{"touchdown_tilt_max_deg", &Limits::touchdown_tilt_max_deg, false, {"tilt_deg", nullptr}},
    LimitOf{"recontact_min_m", &Limits::recontact_min_m, true, {"heatshield_least_m", "backshell_least_m"}},
    LimitOf{"parachute_mach_max", &Limits::parachute_mach_max, false, {"parachute_mach", nullptr}},
    LimitOf{"parachute_pressure_max_Pa", &Limits::parachute_pressure_max_Pa, false, {"parachute_pressure_Pa", nullptr}},
    LimitOf{"timeline_margin_min_s", &Limits::timeline_margin_min_s, true, {"least_margin_s", nullptr}},
};

/// The figure of a case that comes nearest to the limit, and its margin; no numbers: it has none.
std::pair<double, double> nearest(const LimitOf& of, const CaseTable& table, std::size_t row, double bound) {
    std::pair found{unknown, unknown};
    for (const char* name : of.columns) {
        const CaseTable::Column* column = name == nullptr ? nullptr : table.column(name);
        if (column == nullptr || std::isnan(column->values[row])) continue;
        const double value = column->values[row];
        const double margin = of.at_least ? value - bound : bound - value;
        if (std::isnan(found.second) || margin < found.second) found = {value, margin};
    }
    return found;
}

}  // namespace

double CampaignVerdict::fraction() const {
    return cases == 0 ? 0.0 : static_cast<double>(within) / static_cast<double>(cases);
}

bool CampaignVerdict::passes() const {
    return cases > 0 && fraction() >= fraction_min;
}

CampaignVerdict verdict_of(const CaseTable& table, const Limits& limits) {
    CampaignVerdict verdict;
    verdict.cases = table.numbers.size();
    verdict.fraction_min = limits.campaign_within_min_fraction;
    const CaseTable::Column* exceeded = table.column("limits_exceeded");
    for (std::size_t row = 0; row < table.numbers.size(); ++row)
        if (table.outcomes[row] == "touchdown" && exceeded != nullptr && exceeded->values[row] == 0.0) ++verdict.within;
    for (const LimitOf& of : limits_of_columns) {
        LimitMargin one;
        one.limit = of.name;
        one.bound = limits.*of.member;
        for (std::size_t row = 0; row < table.numbers.size(); ++row) {
            if (table.outcomes[row] != "touchdown") continue;
            const auto [value, margin] = nearest(of, table, row, one.bound);
            if (margin < 0.0) ++one.exceeded;
            if (std::isnan(margin) || margin >= one.margin) continue;  // of the first, one.margin is no number
            one.margin = margin;
            one.value = value;
            one.number = table.numbers[row];
        }
        verdict.limits.push_back(one);
    }
    return verdict;
}

std::string verdict_table(const CampaignVerdict& verdict) {
    std::string text =
        fmt::format("{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "limit", "bound", "worst", "margin", "case", "exceeded");
    for (const LimitMargin& one : verdict.limits) {
        if (one.number == 0) {
            text += fmt::format("{:<34}{:>10.5g}{:>10}\n", one.limit, one.bound, "no figure");
            continue;
        }
        text += fmt::format("{:<34}{:>10.5g}{:>10.5g}{:>10.4g}{:>10}{:>10}\n", one.limit, one.bound, one.value,
                            one.margin, one.number, one.exceeded);
    }
    constexpr double percent = 100.0;
    text += fmt::format("{}: {} of {} cases landed within all limits, {:.2f} %; {:.2f} % are required\n",
                        verdict.passes() ? "passed" : "FAILED", verdict.within, verdict.cases,
                        percent * verdict.fraction(), percent * verdict.fraction_min);
    return text;
}

std::string limit_json(const LimitMargin& one) {
    return JsonObject{}
        .text("limit", one.limit)
        .number("bound", one.bound)
        .number("worst", one.value)
        .number("margin", one.margin)
        .count("case", one.number)
        .count("exceeded", one.exceeded)
        .str();
}

std::string verdict_json(const CampaignVerdict& verdict) {
    return JsonObject{}
        .text("verdict", verdict.passes() ? "passed" : "failed")
        .count("within_limits", verdict.within)
        .number("fraction_within", verdict.fraction())
        .number("fraction_required", verdict.fraction_min)
        .raw("limits", json_array(verdict.limits, limit_json))
        .str();
}

}  // namespace aeolis::server::campaign
