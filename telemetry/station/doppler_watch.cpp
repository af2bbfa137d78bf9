// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/doppler_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace aeolis::telemetry {
namespace {

using Feature = SeenByDoppler::Feature;

constexpr double line_before_s = 1.5, line_before_most_s = 4.0;  // chosen: longest from a line's end to the newest
constexpr double past_most_s = 6.0;                              // chosen: two seconds of departures, and a gap
constexpr double line_s = 1.0;                                   // eight estimates without a gap take less
constexpr double estimate_s = 0.125;
constexpr double curvature_hz = 30.0;  // chosen: of a departure while older ones do not show the curvature
constexpr double shared = 5.0;         // estimates that share a window, and so their noise: 0.6 s of eighths
constexpr double rounding_s = 0.01;

/// How far each feature makes the carrier depart, and how far from its predict it may come. Chosen over 500 dispersed
/// landings at 22 dB-Hz. Drag of 0.02 g: 20 Hz. A parachute makes 700 Hz at least, where 19 Hz are the most in the
/// 100 s before; a heatshield 14 to 32 Hz. A reversal: parts of its predicted step. Of the first, in thinner air, 0.6
/// are just reached in 1 landing of 60, and 0.5 where it was taken out; of the others 0.9 are, and 0.3.
struct Limits {
    Feature feature;
    double least, most, within_s;
};
constexpr double least_first_step = 0.58, least_step = 0.6, most_step = 1.6;
constexpr std::array<Limits, 7> limits{{{Feature::entry, 20.0, 100.0, 10.0},
                                        {Feature::parachute, 250.0, std::numeric_limits<double>::infinity(), 40.0},
                                        {Feature::heatshield, 12.0, 100.0, 40.0},
                                        {Feature::first_reversal, least_first_step, most_step, 4.0},
                                        {Feature::second_reversal, least_step, most_step, 6.0},
                                        {Feature::third_reversal, least_step, most_step, 12.0},
                                        {Feature::fourth_reversal, least_step, most_step, 12.0}}};
/// Whether the limits of each feature stand at the place of its number.
consteval bool limits_in_order() {
    for (std::size_t i = 0; i < limits.size(); ++i)
        if (limits[i].feature != static_cast<Feature>(i)) return false;
    return true;
}
static_assert(limits_in_order());
constexpr auto entry_feature = static_cast<std::size_t>(Feature::entry);
constexpr auto parachute = static_cast<std::size_t>(Feature::parachute);
constexpr auto heatshield = static_cast<std::size_t>(Feature::heatshield);
constexpr auto first_reversal = static_cast<std::size_t>(Feature::first_reversal);
constexpr double opening_s = 14.0;  // chosen: until the parachute has opened and the carrier runs smoothly again
constexpr double deviations = 4.0;  // chosen: before drag 2.6 were the most
constexpr int needed_in_row = 3;    // chosen: a single wrong estimate proves nothing
constexpr double predict_sigma_hz = 0.01;

constexpr double drag_window_s = 16.0, drag_grows_s = 4.5;  // by e, as the vehicle falls towards denser air
constexpr double turn_s = 9.0;                              // of the lift, from side to side
constexpr double reversal_window_s = 9.0, turned_since_s = 2.0;
constexpr double rate_s = 1.0;             // over which a rate is taken
constexpr double predict_half_s = 9.5;     // chosen: about a predicted reversal; the next one is 20 s away
constexpr double least_shown_step = 0.08;  // chosen: of the predict; 0.13 to 0.21 are flown
constexpr double least_present = 0.8;      // of a window's estimates

/// A step from 0 to 1 as lift makes it that turns evenly from side to side, `since_s` after its middle.
double turned(double since_s) {
    if (std::abs(since_s) >= 0.5 * turn_s) return since_s > 0.0 ? 1.0 : 0.0;
    return 0.5 + 0.5 * std::sin(std::numbers::pi * since_s / turn_s);
}

/// The same, integrated over time.
double turned_for_s(double since_s) {
    const double from_begin_s = std::clamp(since_s + 0.5 * turn_s, 0.0, turn_s);
    const double angle = std::numbers::pi * (from_begin_s / turn_s - 0.5);
    return 0.5 * (from_begin_s - turn_s / std::numbers::pi * std::cos(angle)) + std::max(0.0, since_s - 0.5 * turn_s);
}

bool is_reversal(std::size_t feature) {
    return feature >= first_reversal;
}

/// The newest points that a window holds; none where too many are missing, or the newest of all is older.
std::span<const MeasuredPoint> window_of(std::span<const MeasuredPoint> points, double window_s) {
    if (points.empty()) return {};
    const double from_s = points.back().time_s - window_s - rounding_s;
    const auto first = std::ranges::find_if(points, [&](const MeasuredPoint& point) { return point.time_s >= from_s; });
    const auto held = points.subspan(static_cast<std::size_t>(first - points.begin()));
    const bool whole = static_cast<double>(held.size()) >= least_present * window_s / estimate_s;
    return whole ? held : std::span<const MeasuredPoint>{};
}

}  // namespace

std::optional<DopplerDeparture::Departure> DopplerDeparture::add(double time_s, double frequency_hz, double sigma_hz) {
    const auto forget = [&](auto& all, double kept_s) {
        std::erase_if(all, [&](const auto& old) { return old.time_s < time_s - kept_s - rounding_s; });
    };
    forget(estimates_, line_before_most_s + line_s);
    forget(past_, past_most_s);
    const Estimate newest{time_s, frequency_hz, sigma_hz};
    estimates_.push_back(newest);
    const auto departure = from_line(newest);
    if (!departure) return {};
    const auto beyond = beyond_past(time_s, *departure);
    past_.push_back({time_s, departure->hz});
    return beyond;
}

/// The departure less the mean of older ones, or by itself where too few are known.
std::optional<DopplerDeparture::Departure> DopplerDeparture::beyond_past(double time_s,
                                                                         const Departure& departure) const {
    const auto recent = std::ranges::find_if(
        past_, [&](const Past& past) { return past.time_s > time_s - line_before_s + rounding_s; });
    const auto count = static_cast<std::size_t>(recent - past_.begin());
    if (count < past_departures) return Departure{departure.hz, std::hypot(departure.sigma_hz, curvature_hz)};
    double mean_hz = 0.0, spread = 0.0;
    const auto older = std::span{past_}.subspan(count - past_departures, past_departures);
    for (const Past& past : older) mean_hz += past.hz / past_departures;
    for (const Past& past : older) spread += (past.hz - mean_hz) * (past.hz - mean_hz) / (past_departures - 1);
    return Departure{departure.hz - mean_hz, std::hypot(departure.sigma_hz, std::sqrt(spread))};
}

/// The departure from the line before `newest`, with the noise of both alone.
std::optional<DopplerDeparture::Departure> DopplerDeparture::from_line(const Estimate& newest) const {
    const auto after = std::ranges::find_if(
        estimates_, [&](const Estimate& each) { return each.time_s > newest.time_s - line_before_s + rounding_s; });
    const auto end = static_cast<std::size_t>(after - estimates_.begin());
    if (end < line_estimates) return {};
    const auto line = std::span{estimates_}.subspan(end - line_estimates, line_estimates);
    if (line.back().time_s - line.front().time_s > line_s) return {};
    constexpr double count = line_estimates;
    double time_s = 0.0, frequency_hz = 0.0, variance = 0.0;
    for (const Estimate& each : line) {
        time_s += each.time_s / count;
        frequency_hz += each.frequency_hz / count;
        variance += each.sigma_hz * each.sigma_hz / count;
    }
    double squares = 0.0, slope = 0.0;
    for (const Estimate& each : line) {
        squares += (each.time_s - time_s) * (each.time_s - time_s);
        slope += (each.time_s - time_s) * (each.frequency_hz - frequency_hz);
    }
    slope /= squares;
    const double ahead_s = newest.time_s - time_s;
    const double of_line = shared * variance * (1.0 / count + ahead_s * ahead_s / squares);
    return Departure{newest.frequency_hz - frequency_hz - slope * ahead_s,
                     std::sqrt(of_line + newest.sigma_hz * newest.sigma_hz)};
}

DopplerWatch::DopplerWatch(const TimeTable& predict_hz, Ert entry, std::span<const double> reversals_s)
    : entry_(entry) {
    DopplerWatch predicted{*this};
    for (double time_s = predict_hz.first_s(); time_s <= predict_hz.last_s(); time_s += estimate_s) {
        if (time_s < -drag_window_s) continue;
        const double hz = predict_hz.at(time_s);
        predicted.remember({time_s, hz, predict_sigma_hz, hz});
        const auto from_line = predicted.departure_.add(time_s, hz, predict_sigma_hz);
        for (const std::size_t i : {entry_feature, parachute, heatshield}) {
            if (time_s < 0.0 || watched_[i].expected_s || (i > 0 && !watched_[i - 1].expected_s)) continue;
            if (i == heatshield && time_s < *watched_[parachute].expected_s + opening_s) continue;
            if (const auto departs = predicted.departure(i, from_line))
                watched_[i].expected_s = first_of_three(predicted.watched_[i], i, time_s, *departs);
        }
    }
    expect_reversals(predict_hz, reversals_s);
}

/// Finds the step of each reversal in the predict: beside a cubic course, and some seconds from the time given, as lift
/// goes on turning.
void DopplerWatch::expect_reversals(const TimeTable& predict_hz, std::span<const double> reversals_s) {
    constexpr double sought_s = 2.5, sought_step_s = 0.25;
    constexpr int course = 3;
    for (std::size_t i = 0; i < std::min(reversals_s.size(), reversals); ++i) {
        Watched& watched = watched_[first_reversal + i];
        double clearest = 0.0;
        for (double middle_s = reversals_s[i] - sought_s; middle_s <= reversals_s[i] + sought_s;
             middle_s += sought_step_s) {
            std::vector<MeasuredPoint> rates;
            for (double time_s = middle_s - predict_half_s; time_s <= middle_s + predict_half_s; time_s += estimate_s) {
                const double rate =
                    (predict_hz.at(time_s + 0.5 * rate_s) - predict_hz.at(time_s - 0.5 * rate_s)) / rate_s;
                if (rate > 0.0) rates.push_back({time_s, std::log(rate), 0.0});
            }
            const auto step =
                amplitude_of([&](double time_s) { return turned(time_s - middle_s); }, rates, course, shared);
            if (!step || std::abs(step->value) < least_shown_step ||
                std::abs(step->value) < std::max(deviations, clearest) * step->sigma)
                continue;
            clearest = std::abs(step->value) / step->sigma;
            watched.expected_s = middle_s;
            watched.step = step->value;
        }
    }
}

std::optional<double> DopplerWatch::expected_s(SeenByDoppler::Feature feature) const {
    return watched_[static_cast<std::size_t>(feature)].expected_s;
}

bool DopplerWatch::may_come(std::size_t feature, double time_s) const {
    const Watched& watched = watched_[feature];
    if (!watched.expected_s || watched.seen_s || std::abs(time_s - *watched.expected_s) > limits[feature].within_s)
        return false;
    const auto& opened_s = watched_[parachute].seen_s;
    return feature != heatshield || (opened_s && time_s > *opened_s + opening_s);
}

void DopplerWatch::remember(const Estimate& estimate) {
    std::erase_if(estimates_,
                  [&](const Estimate& old) { return old.time_s < estimate.time_s - drag_window_s - rounding_s; });
    std::erase_if(rates_, [&](const MeasuredPoint& old) {
        return old.time_s < estimate.time_s - reversal_window_s - rate_s - rounding_s;
    });
    estimates_.push_back(estimate);
    const auto before = std::ranges::find_if(estimates_, [&](const Estimate& each) {
        return std::abs(estimate.time_s - rate_s - each.time_s) < rounding_s;
    });
    if (before == estimates_.end()) return;
    const double rate = estimate.frequency_hz - before->frequency_hz;
    const double predicted = estimate.predict_hz - before->predict_hz;
    if (rate <= 0.0 || predicted <= 0.0) return;
    const double time_s = estimate.time_s - 0.5 * rate_s;
    double value = std::log(rate / predicted);
    for (const Watched& reversal : std::span{watched_}.subspan(first_reversal))
        if (reversal.expected_s) value += reversal.step * turned(time_s - *reversal.expected_s);
    rates_.push_back({time_s, value, std::hypot(estimate.sigma_hz, before->sigma_hz) / rate});
}

double DopplerWatch::rate_hzps() const {
    const auto before = std::ranges::find_if(
        estimates_, [&](const Estimate& each) { return each.time_s > estimates_.back().time_s - rate_s - rounding_s; });
    const double apart_s = estimates_.back().time_s - before->time_s;
    return apart_s > 0.0 ? (estimates_.back().frequency_hz - before->frequency_hz) / apart_s : 0.0;
}

/// How far drag that grows by e in some seconds has taken the carrier.
std::optional<DopplerWatch::Departure> DopplerWatch::by_drag() const {
    std::vector<MeasuredPoint> all;
    all.reserve(estimates_.size());
    for (const Estimate& each : estimates_) all.push_back({each.time_s, each.frequency_hz, each.sigma_hz});
    const auto window = window_of(all, drag_window_s);
    if (window.empty()) return {};
    const double now_s = window.back().time_s;
    constexpr int gravity = 2;
    const auto found =
        amplitude_of([&](double time_s) { return std::exp((time_s - now_s) / drag_grows_s); }, window, gravity, shared);
    if (!found) return {};
    return Departure{found->value, found->sigma};
}

/// How much of the predicted step the rate has taken, if its middle was some seconds ago.
std::optional<DopplerWatch::Departure> DopplerWatch::by_reversal(const Watched& watched) const {
    const auto window = window_of(rates_, reversal_window_s);
    if (window.empty() || window.back().time_s < estimates_.back().time_s - rate_s) return {};
    const double middle_s = window.back().time_s - turned_since_s;
    const auto found = amplitude_of([&](double time_s) { return turned(time_s - middle_s); }, window, 1, shared);
    if (!found) return {};
    return Departure{found->value / watched.step, found->sigma / std::abs(watched.step)};
}

std::optional<DopplerWatch::Departure> DopplerWatch::departure(std::size_t feature,
                                                               const std::optional<Departure>& from_line) const {
    if (feature == entry_feature) return by_drag();
    return is_reversal(feature) ? by_reversal(watched_[feature]) : from_line;
}

/// Takes a departure; when it is the third in a row that shows the feature, gives the time of the first.
std::optional<double> DopplerWatch::first_of_three(Watched& watched, std::size_t feature, double time_s,
                                                   const Departure& departure) const {
    const bool shows = departure.hz >= limits[feature].least && departure.hz <= limits[feature].most &&
                       departure.hz >= deviations * departure.sigma_hz;
    if (!shows) {
        watched.in_row = 0;
        if (departure.hz <= limits[feature].most) watched.below_s = time_s;
        return {};
    }
    if (watched.in_row == 0) watched.first_s = time_s;
    // The parachute opens in a second: that a line lies before it is enough.
    const bool came_now =
        feature == parachute || (watched.below_s && watched.first_s - *watched.below_s <= line_before_most_s);
    if (!came_now || ++watched.in_row < needed_in_row) return {};
    return watched.first_s;
}

std::optional<SeenByDoppler> DopplerWatch::hear(const ReceivedCarrier& carrier) {
    if (!carrier.estimate) return {};
    const double time_s = static_cast<double>(carrier.middle.microseconds - entry_.microseconds) * 1.0e-6;
    const double frequency_hz = carrier.predict_hz + carrier.estimate->residual_hz;
    remember({time_s, frequency_hz, carrier.estimate->sigma_hz, carrier.predict_hz});
    const auto from_line = departure_.add(time_s, frequency_hz, carrier.estimate->sigma_hz);
    for (std::size_t i = 0; i < features; ++i) {
        if (!may_come(i, time_s)) continue;
        auto departs = departure(i, from_line);
        if (!departs) continue;
        watched_[i].seen_s = first_of_three(watched_[i], i, time_s, *departs);
        if (!watched_[i].seen_s) continue;
        if (is_reversal(i)) {  // what the step of the rate has come to by now
            const double hz = watched_[i].step * rate_hzps() * turned_for_s(turned_since_s);
            *departs = {departs->hz * hz, departs->sigma_hz * std::abs(hz)};
        }
        const Ert at{entry_.microseconds + std::llround(*watched_[i].seen_s * 1.0e6)};
        return SeenByDoppler{static_cast<Feature>(i), carrier.ert, at, departs->hz, departs->sigma_hz};
    }
    return {};
}

}  // namespace aeolis::telemetry
