// SPDX-License-Identifier: Apache-2.0
#include "common/ephemeris.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace aeolis {
namespace {

/// The `count` states that are about `time`: as many before it as behind, at the ends the outermost.
std::span<const EphemerisState> window(const Ephemeris& ephemeris, EphemerisTime time, std::size_t count) {
    const auto& states = ephemeris.states;
    count = std::min(count, states.size());
    const auto after = std::ranges::upper_bound(states, time, {}, &EphemerisState::time);
    auto first = after - states.begin();
    // Of an odd number the middle one is the nearest.
    if (count % 2 == 1 && first > 0 &&
        (after == states.end() || time - states[static_cast<std::size_t>(first) - 1].time < after->time - time))
        --first;
    first -= static_cast<std::ptrdiff_t>(count / 2);
    first = std::clamp<std::ptrdiff_t>(first, 0, static_cast<std::ptrdiff_t>(states.size() - count));
    return std::span{states}.subspan(static_cast<std::size_t>(first), count);
}

struct ValueAndRate {
    double value = 0.0, rate = 0.0;
};

/// The polynomial through values and slopes, by divided differences over doubled nodes.
ValueAndRate hermite(std::span<const double> t, std::span<const double> value, std::span<const double> slope,
                     double at) {
    const std::size_t nodes = 2 * t.size();
    std::vector<double> difference(nodes);
    for (std::size_t i = 0; i < nodes; ++i) difference[i] = value[i / 2];
    ValueAndRate sum{difference[0], 0.0};
    ValueAndRate product{1.0, 0.0};
    for (std::size_t order = 1; order < nodes; ++order) {
        // In place: from here on difference[i] is that of the nodes i … i + order.
        for (std::size_t i = 0; i + order < nodes; ++i) {
            const bool doubled = order == 1 && i % 2 == 0;
            difference[i] =
                doubled ? slope[i / 2] : (difference[i + 1] - difference[i]) / (t[(i + order) / 2] - t[i / 2]);
        }
        const double step = at - t[(order - 1) / 2];
        product = {product.value * step, product.rate * step + product.value};
        sum.value += difference[0] * product.value;
        sum.rate += difference[0] * product.rate;
    }
    return sum;
}

double lagrange(std::span<const double> t, std::vector<double> value, double at) {
    for (std::size_t order = 1; order < t.size(); ++order)
        for (std::size_t i = 0; i + order < t.size(); ++i)
            value[i] = ((at - t[i + order]) * value[i] + (t[i] - at) * value[i + 1]) / (t[i] - t[i + order]);
    return value.front();
}

}  // namespace

std::optional<EphemerisState> state_at(const Ephemeris& ephemeris, EphemerisTime time) {
    if (ephemeris.states.empty() || time < ephemeris.start || time > ephemeris.stop) return std::nullopt;
    const bool slopes = ephemeris.interpolation == Interpolation::hermite;
    const auto about = window(ephemeris, time, slopes ? (ephemeris.degree + 1) / 2 : ephemeris.degree + 1);
    std::vector<double> t, position, velocity;
    for (const auto& state : about) t.push_back(state.time - about.front().time);
    const double at = time - about.front().time;
    EphemerisState result{time, {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        position.clear(), velocity.clear();
        for (const auto& state : about) {
            position.push_back(state.position_km.at(axis));
            velocity.push_back(state.velocity_kmps.at(axis));
        }
        if (slopes) {
            const auto found = hermite(t, position, velocity, at);
            result.position_km.at(axis) = found.value;
            result.velocity_kmps.at(axis) = found.rate;
        } else {
            result.position_km.at(axis) = lagrange(t, position, at);
            result.velocity_kmps.at(axis) = lagrange(t, velocity, at);
        }
    }
    return result;
}

std::optional<AttitudeState> attitude_at(const AttitudeHistory& history, EphemerisTime time) {
    const auto& states = history.states;
    if (states.empty() || time < history.start || time > history.stop) return std::nullopt;
    const auto after = std::ranges::upper_bound(states, time, {}, &AttitudeState::time);
    if (after == states.begin()) return states.front();
    const AttitudeState& from = *(after - 1);
    if (after == states.end()) return from;
    const double part = (time - from.time) / (after->time - from.time);
    double cosine = 0.0;
    for (std::size_t i = 0; i < 4; ++i) cosine += from.q_BA.at(i) * after->q_BA.at(i);
    const double sign = cosine < 0.0 ? -1.0 : 1.0;  // q and -q are one rotation
    const double angle = std::acos(std::min(1.0, cosine * sign));
    AttitudeState result{time, {}, std::nullopt};
    constexpr double angle_small_rad = 1e-9;
    const double weight_from = angle < angle_small_rad ? 1.0 - part : std::sin((1.0 - part) * angle) / std::sin(angle);
    const double weight_after = angle < angle_small_rad ? part : std::sin(part * angle) / std::sin(angle);
    for (std::size_t i = 0; i < 4; ++i)
        result.q_BA.at(i) = weight_from * from.q_BA.at(i) + sign * weight_after * after->q_BA.at(i);
    if (from.w_AB_B_rps && after->w_AB_B_rps) {
        result.w_AB_B_rps.emplace();
        for (std::size_t i = 0; i < 3; ++i)
            result.w_AB_B_rps->at(i) = (1.0 - part) * from.w_AB_B_rps->at(i) + part * after->w_AB_B_rps->at(i);
    }
    return result;
}

}  // namespace aeolis
