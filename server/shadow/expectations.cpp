// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/expectations.hpp"

#include "server/shadow/prospect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace aeolis::server::shadow {
namespace {

constexpr std::int32_t never_fired = std::numeric_limits<std::int32_t>::min();
// Chosen: what the vehicle may do beyond all cases before it departs. Flights that go as expected must not be told to
// depart, in one landing of a hundred.
constexpr double tolerated_part = 0.25, tolerated_least_s = 1.0;
constexpr double spread_least_s = 1.0 / 64.0;  // a cycle: what differs by less tells nothing
constexpr double least_determinant = 1.0e-6;   // of two correlated times, relative: they say the same
constexpr std::size_t regressors_max = 2;
// Chosen: a case that ends so much before the others is lost, not early; so few of them say nothing of where the others
// are at that time.
constexpr std::size_t lost_before_s = 60, cases_per_lost = 100;

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double covariance(const std::vector<double>& a, const std::vector<double>& b) {
    const double mean_a = mean_of(a), mean_b = mean_of(b);
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
    return sum;
}

/// Coefficients of the least-squares prediction of `y` from one or two `x`, about the means. The second is left out
/// where it tells what the first does.
std::array<double, regressors_max> least_squares(const std::vector<double>& y,
                                                 const std::vector<std::vector<double>>& x) {
    std::array<double, regressors_max> by{};
    if (x.empty()) return by;
    const double xx = covariance(x[0], x[0]), xy = covariance(x[0], y);
    if (xx <= 0.0) return by;  // in those cases it does not differ
    by[0] = xy / xx;
    if (x.size() < 2) return by;
    const double zz = covariance(x[1], x[1]), xz = covariance(x[0], x[1]), zy = covariance(x[1], y);
    const double determinant = xx * zz - xz * xz;
    if (determinant <= least_determinant * xx * zz) return by;
    by[0] = (xy * zz - zy * xz) / determinant;
    by[1] = (zy * xx - xy * xz) / determinant;
    return by;
}

/// The cases that tell of courses: all, but for a few that were lost long before the others ended.
std::vector<const Course*> courses_to_the_end(std::span<const Course> courses) {
    std::vector<std::size_t> lengths;
    for (const Course& course : courses) lengths.push_back(course.seconds.size());
    std::ranges::sort(lengths);
    const std::size_t usual = lengths.empty() ? 0 : lengths[lengths.size() / 2];
    std::vector<const Course*> all, flown;
    for (const Course& course : courses) {
        all.push_back(&course);
        if (course.seconds.size() + lost_before_s >= usual) flown.push_back(&course);
    }
    return (all.size() - flown.size()) * cases_per_lost <= all.size() ? flown : all;
}

}  // namespace

bool ExpectedTime::operator==(const ExpectedTime& other) const {
    const auto same = [](const Interval& a, const Interval& b) { return a.from == b.from && a.to == b.to; };
    return e_s == other.e_s && cases == other.cases && same(tolerated, other.tolerated) &&
           interval_99.has_value() == other.interval_99.has_value() &&
           (!interval_99 || same(*interval_99, *other.interval_99));
}

v1::PlanEnsemble ensemble_of(std::span<const Course> courses, std::uint32_t order, Sclk from, Sclk entry) {
    v1::PlanEnsemble ensemble;
    ensemble.set_order(order);
    ensemble.set_cases(static_cast<std::uint32_t>(courses.size()));
    ensemble.set_from_e_s(from - entry);
    std::size_t rows = 0;
    double first_s = 0.0;
    bool any = false;
    for (const Course& course : courses) {
        rows = std::max(rows, course.fired.size());
        if (course.seconds.empty()) continue;
        const double e_s = course.first - entry;
        first_s = any ? std::min(first_s, e_s) : e_s;
        any = true;
    }
    for (std::size_t row = 0; row < rows; ++row) {
        auto& firings = *ensemble.add_firings();
        firings.set_row(static_cast<std::uint32_t>(row));
        for (const Course& course : courses) {
            // What had fired before is the same in all cases, and says nothing of when it is to be expected.
            const bool fired = row < course.fired.size() && course.fired[row] && *course.fired[row] > from;
            firings.add_ticks(fired ? static_cast<std::int32_t>(course.fired[row]->ticks() - entry.ticks())
                                    : never_fired);
        }
    }
    ensemble.set_first_e_s(static_cast<std::int32_t>(first_s));
    const auto flown = courses_to_the_end(courses);
    for (std::size_t second = 0;; ++second) {
        std::array<std::vector<double>, quantities> values;
        for (const Course* course : flown) {
            if (second >= course->seconds.size()) continue;
            const Course::Second& at = course->seconds[second];
            values[0].push_back(at.altitude_m);
            values[1].push_back(at.speed_mps);
            values[2].push_back(at.range_rate_mps);
        }
        // Once a case has ended, the others are those that fly longer: no sample of all.
        if (values[0].size() < flown.size() || flown.empty()) break;
        for (std::size_t i = 0; i < quantities; ++i) {
            std::ranges::sort(values[i]);
            auto& out = i == 0   ? *ensemble.mutable_altitude_m()
                        : i == 1 ? *ensemble.mutable_speed_mps()
                                 : *ensemble.mutable_range_rate_mps();
            for (const std::size_t at : {std::size_t{0}, values[i].size() / 2, values[i].size() - 1})
                out.Add(static_cast<float>(values[i][at]));
        }
    }
    return ensemble;
}

double Expectations::Range::margin() const {
    return tolerated_part * (most - least);
}

Expectations::Expectations(const dictionary::Dictionary& dictionary, Sclk entry)
    : entry_(entry), told_(dictionary.timeline.size()) {}

void Expectations::take(const v1::PlanEnsemble& ensemble) {
    withdraw();
    cases_ = ensemble.cases();
    fired_.assign(told_.size(), {});
    spread_s_.assign(told_.size(), 0.0);
    for (const auto& firings : ensemble.firings()) {
        if (firings.row() >= fired_.size()) continue;
        auto& row = fired_[firings.row()];
        std::vector<double> times;
        for (const std::int32_t ticks : firings.ticks()) {
            row.push_back(ticks == never_fired ? never : ticks * seconds_per_tick);
            if (ticks != never_fired) times.push_back(row.back());
        }
        if (times.size() > 1)
            spread_s_[firings.row()] = std::sqrt(covariance(times, times) / static_cast<double>(times.size() - 1));
    }
    first_e_s_ = ensemble.first_e_s();
    const auto read = [&](Quantity quantity, const auto& values) {
        auto& ranges = ranges_[static_cast<std::size_t>(quantity)];
        for (int i = 0; i + 2 < values.size(); i += 3) {
            Range& range = ranges.emplace_back();
            range.least = values[i];
            range.median = values[i + 1];
            range.most = values[i + 2];
        }
    };
    read(Quantity::altitude_m, ensemble.altitude_m());
    read(Quantity::speed_mps, ensemble.speed_mps());
    read(Quantity::range_rate_mps, ensemble.range_rate_mps());
}

bool Expectations::tell_departures() const {
    return cases_ >= values_for_99;
}

void Expectations::withdraw() {
    cases_ = 0;
    fired_.clear();
    spread_s_.clear();
    for (auto& ranges : ranges_) ranges.clear();
}

void Expectations::fired(std::size_t row, Sclk at) {
    if (row < told_.size() && !told_[row]) told_[row] = at;
}

/// The latest rows before this one that were told and differ between cases, the latest first.
std::vector<std::size_t> Expectations::regressors(std::size_t before) const {
    std::vector<std::size_t> rows;
    for (std::size_t row = before; row-- > 0 && rows.size() < regressors_max;)
        if (told_[row] && spread_s_[row] > spread_least_s) rows.push_back(row);
    return rows;
}

std::optional<ExpectedTime> Expectations::expected(std::size_t row) const {
    if (!known() || row >= fired_.size()) return std::nullopt;
    const auto by = regressors(row);
    std::vector<double> y;
    std::vector<std::vector<double>> x(by.size());
    for (std::size_t i = 0; i < fired_[row].size(); ++i) {
        if (fired_[row][i] == never || std::ranges::any_of(by, [&](std::size_t r) { return fired_[r][i] == never; }))
            continue;
        y.push_back(fired_[row][i]);
        for (std::size_t k = 0; k < by.size(); ++k) x[k].push_back(fired_[by[k]][i]);
    }
    if (y.empty()) return std::nullopt;
    const auto slope = least_squares(y, x);
    ExpectedTime time;
    time.cases = static_cast<std::uint32_t>(y.size());
    const double mean_s = mean_of(y);
    double shift_s = mean_s;
    std::vector<double> residuals{y};
    for (double& each : residuals) each -= mean_s;
    for (std::size_t k = 0; k < by.size(); ++k) {
        const double mean_x_s = mean_of(x[k]);
        shift_s += slope[k] * (*told_[by[k]] - entry_ - mean_x_s);
        for (std::size_t i = 0; i < y.size(); ++i) residuals[i] -= slope[k] * (x[k][i] - mean_x_s);
    }
    const Values of = values_of(std::move(residuals));
    time.e_s = shift_s + of.median;
    if (of.interval_99) time.interval_99 = {shift_s + of.interval_99->from, shift_s + of.interval_99->to};
    const double margin_s = tolerated_part * (of.most - of.least) + tolerated_least_s;
    time.tolerated = {shift_s + of.least - margin_s, shift_s + of.most + margin_s};
    return time;
}

std::optional<Expectations::Range> Expectations::range(Quantity quantity, Sclk at) const {
    const auto& ranges = ranges_[static_cast<std::size_t>(quantity)];
    const double place = at - entry_ - first_e_s_;
    if (place < 0.0 || place + 1.0 >= static_cast<double>(ranges.size())) return std::nullopt;
    const auto second = static_cast<std::size_t>(place);
    const Range &a = ranges[second], &b = ranges[second + 1];
    const double part = place - static_cast<double>(second);
    const auto between = [&](double from, double to) { return from + part * (to - from); };
    Range range;
    range.least = between(a.least, b.least);
    range.median = between(a.median, b.median);
    range.most = between(a.most, b.most);
    return range;
}

}  // namespace aeolis::server::shadow
