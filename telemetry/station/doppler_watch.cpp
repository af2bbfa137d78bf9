// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/doppler_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace aeolis::telemetry {
namespace {

constexpr double line_before_s = 1.5, line_before_most_s = 4.0;  // chosen: longest from a line's end to the newest
constexpr double past_most_s = 6.0;                              // chosen: two seconds of departures, and a gap
constexpr double line_s = 1.0;                                   // eight estimates without a gap take less
constexpr double estimate_s = 0.125;
constexpr double curvature_hz = 30.0;  // chosen: of a departure while older ones do not show the curvature
constexpr double shared = 5.0;         // estimates that share a window, and so their noise: 0.6 s of eighths
constexpr double rounding_s = 0.01;

/// How far each feature makes the carrier depart, and how far from its predict it may come. Chosen over 500 dispersed
/// landings at 22 dB-Hz: 1.2 Hz at most before drag is felt, which makes 106 Hz at its greatest; a parachute makes
/// 700 Hz at least, where 19 Hz are the most in the 100 s before; a heatshield 14 to 32 Hz.
struct Limits {
    double least_hz, most_hz, within_s;
};
constexpr std::array<Limits, 3> limits{
    {{2.0, 100.0, 15.0}, {250.0, std::numeric_limits<double>::infinity(), 40.0}, {12.0, 100.0, 40.0}}};
constexpr std::size_t parachute = static_cast<std::size_t>(SeenByDoppler::Feature::parachute);
constexpr std::size_t heatshield = static_cast<std::size_t>(SeenByDoppler::Feature::heatshield);
constexpr double opening_s = 14.0;  // chosen: until the parachute has opened and the carrier runs smoothly again
constexpr double deviations = 4.0;  // chosen: before drag 2.6 were the most
constexpr int needed_in_row = 3;    // chosen: a single wrong estimate proves nothing
constexpr double predict_sigma_hz = 0.01;

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

DopplerWatch::DopplerWatch(const TimeTable& predict_hz, Ert entry) : entry_(entry) {
    DopplerDeparture departure;
    std::array<Watched, features> predicted{};
    for (double time_s = std::max(0.0, predict_hz.first_s()); time_s <= predict_hz.last_s(); time_s += estimate_s) {
        const auto departs = departure.add(time_s, predict_hz.at(time_s), predict_sigma_hz);
        if (!departs) continue;
        for (std::size_t i = 0; i < features; ++i) {
            if (watched_[i].expected_s || (i > 0 && !watched_[i - 1].expected_s)) continue;
            if (i == heatshield && time_s < *watched_[parachute].expected_s + opening_s) continue;
            watched_[i].expected_s = first_of_three(predicted[i], i, time_s, *departs);
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

/// Takes a departure; when it is the third in a row that shows the feature, gives the time of the first.
std::optional<double> DopplerWatch::first_of_three(Watched& watched, std::size_t feature, double time_s,
                                                   const DopplerDeparture::Departure& departure) const {
    const bool shows = departure.hz >= limits[feature].least_hz && departure.hz <= limits[feature].most_hz &&
                       departure.hz >= deviations * departure.sigma_hz;
    if (!shows) {
        watched.in_row = 0;
        if (departure.hz <= limits[feature].most_hz) watched.below_s = time_s;
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
    const auto departure =
        departure_.add(time_s, carrier.predict_hz + carrier.estimate->residual_hz, carrier.estimate->sigma_hz);
    if (!departure) return {};
    for (std::size_t i = 0; i < features; ++i) {
        if (!may_come(i, time_s)) continue;
        watched_[i].seen_s = first_of_three(watched_[i], i, time_s, *departure);
        if (!watched_[i].seen_s) continue;
        const Ert at{entry_.microseconds + std::llround(*watched_[i].seen_s * 1.0e6)};
        return SeenByDoppler{static_cast<SeenByDoppler::Feature>(i), carrier.ert, at, departure->hz,
                             departure->sigma_hz};
    }
    return {};
}

}  // namespace aeolis::telemetry
