// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_table.hpp"

#include "server/campaign/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::campaign {
namespace {

constexpr std::string_view draw_prefix = "draw.";
constexpr double chance_sigmas = 3.0;

bool is_draw(const CaseTable::Column& column) {
    return column.name.starts_with(draw_prefix);
}

Correlation correlation_of(const CaseTable::Column& figure, const CaseTable::Column& draw) {
    Moments of_figure, of_draw;
    for (std::size_t i = 0; i < figure.values.size(); ++i) {
        if (std::isnan(figure.values[i]) || std::isnan(draw.values[i])) continue;
        of_figure.add(figure.values[i]);
        of_draw.add(draw.values[i]);
    }
    Correlation found{figure.name, draw.name.substr(draw_prefix.size()), 0.0, 0.0, of_figure.count(), 1.0};
    if (found.cases < 3 || of_figure.deviation() == 0.0 || of_draw.deviation() == 0.0) return found;
    double products = 0.0;
    for (std::size_t i = 0; i < figure.values.size(); ++i)
        if (!std::isnan(figure.values[i]) && !std::isnan(draw.values[i]))
            products += (figure.values[i] - of_figure.mean()) * (draw.values[i] - of_draw.mean());
    const auto n = static_cast<double>(found.cases);
    found.r = products / ((n - 1.0) * of_figure.deviation() * of_draw.deviation());
    found.slope = found.r * of_figure.deviation();
    found.by_chance = std::min(1.0, chance_sigmas / std::sqrt(n));
    return found;
}

struct Sample {
    std::vector<double> ordered;
    Moments moments;

    explicit Sample(const CaseTable::Column& column) {
        for (const double value : column.values)
            if (!std::isnan(value)) ordered.push_back(value);
        std::ranges::sort(ordered);
        for (const double value : ordered) moments.add(value);
    }
    double percentile(double fraction) const {
        Percentile at{fraction, ordered.size()};
        for (const double value : ordered) at.add(value);
        return at.value();
    }
};

}  // namespace

const CaseTable::Column* CaseTable::column(std::string_view name) const {
    const auto found = std::ranges::find(columns, name, &Column::name);
    return found == columns.end() ? nullptr : &*found;
}

std::string csv_of(const CaseTable& table) {
    std::string text = "case,outcome";
    for (const auto& column : table.columns) text += "," + column.name;
    text += '\n';
    for (std::size_t row = 0; row < table.numbers.size(); ++row) {
        text += fmt::format("{},{}", table.numbers[row], table.outcomes[row]);
        for (const auto& column : table.columns)
            text += std::isnan(column.values[row]) ? std::string{","} : fmt::format(",{}", column.values[row]);
        text += '\n';
    }
    return text;
}

std::vector<Correlation> correlations(const CaseTable& table, const std::vector<std::string>& figures) {
    std::vector<Correlation> all;
    for (const std::string& name : figures) {
        const CaseTable::Column* figure = table.column(name);
        if (figure == nullptr) continue;
        const auto first = static_cast<std::ptrdiff_t>(all.size());
        for (const auto& column : table.columns) {
            if (!is_draw(column)) continue;
            const Correlation one = correlation_of(*figure, column);
            if (one.by_chance < 1.0) all.push_back(one);
        }
        std::ranges::stable_sort(all.begin() + first, all.end(), std::ranges::greater{},
                                 [](const Correlation& one) { return std::abs(one.r); });
    }
    return all;
}

std::vector<Compared> compared(const CaseTable& a, const CaseTable& b) {
    constexpr double low = 0.01, middle = 0.5, high = 0.99;
    std::vector<Compared> all;
    for (const auto& column : a.columns) {
        const CaseTable::Column* other = b.column(column.name);
        if (other == nullptr || is_draw(column)) continue;
        const Sample of_a{column}, of_b{*other};
        if (of_a.ordered.empty() || of_b.ordered.empty()) continue;
        Compared one;
        one.name = column.name;
        one.cases_a = of_a.moments.count();
        one.cases_b = of_b.moments.count();
        one.p1_a = of_a.percentile(low);
        one.p50_a = of_a.percentile(middle);
        one.p99_a = of_a.percentile(high);
        one.p1_b = of_b.percentile(low);
        one.p50_b = of_b.percentile(middle);
        one.p99_b = of_b.percentile(high);
        one.mean_a = of_a.moments.mean();
        one.mean_b = of_b.moments.mean();
        one.sigma_a = of_a.moments.deviation();
        one.sigma_b = of_b.moments.deviation();
        const double error = std::sqrt(one.sigma_a * one.sigma_a / static_cast<double>(one.cases_a) +
                                       one.sigma_b * one.sigma_b / static_cast<double>(one.cases_b));
        if (error > 0.0) one.difference_sigmas = (one.mean_b - one.mean_a) / error;
        all.push_back(one);
    }
    return all;
}

}  // namespace aeolis::server::campaign
