// SPDX-License-Identifier: Apache-2.0
#include "commands/solution_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>

namespace aeolis::commands {
namespace {

// Chosen: a solution of ground's own is equal, so the bounds only allow for rounding by people. The vehicle lands with
// each error at its bound.
constexpr double same_epoch_s = 1.0 / 128.0;  // half a tick of the clock
constexpr double position_max_m = 1000.0, velocity_max_mps = 1.0;
constexpr double target_moved_max_m = 30'000.0, radius_moved_max_m = 3000.0;

std::optional<double> value_of(std::span<const NamedValue> values, std::string_view name) {
    const auto found = std::ranges::find(values, name, &NamedValue::name);
    return found == values.end() ? std::nullopt : std::optional{found->value};
}

/// Distance between two vectors; none when one of them is not given.
std::optional<double> distance(std::span<const NamedValue> one, std::span<const NamedValue> other,
                               const std::array<std::string_view, 3>& names) {
    std::array<double, 3> difference{};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto first = value_of(one, names[i]), second = value_of(other, names[i]);
        if (!first || !second) return std::nullopt;
        difference[i] = *first - *second;
    }
    return std::hypot(difference[0], difference[1], difference[2]);
}

/// Distance between two targets along the ground; none when one of them is not given.
std::optional<double> target_distance_m(std::span<const NamedValue> one, std::span<const NamedValue> other) {
    const auto direction = [](std::span<const NamedValue> of) -> std::optional<std::array<double, 3>> {
        constexpr double degree_rad = std::numbers::pi / 180.0;
        const auto latitude = value_of(of, "target_latitude_deg"), longitude = value_of(of, "target_longitude_deg");
        if (!latitude || !longitude) return std::nullopt;
        const double up = *latitude * degree_rad, east = *longitude * degree_rad;
        return std::array{std::cos(up) * std::cos(east), std::cos(up) * std::sin(east), std::sin(up)};
    };
    const auto first = direction(one), second = direction(other);
    const auto radius_m = value_of(other, "target_radius_m");
    if (!first || !second || !radius_m) return std::nullopt;
    const double chord = std::hypot((*first)[0] - (*second)[0], (*first)[1] - (*second)[1], (*first)[2] - (*second)[2]);
    return 2.0 * std::asin(std::min(1.0, 0.5 * chord)) * *radius_m;
}

/// Why the arguments are not near a solution of the same epoch; empty: they are near.
std::string difference_of(std::span<const NamedValue> solution, std::span<const NamedValue> arguments) {
    const auto position_m = distance(arguments, solution, {"position_x_m", "position_y_m", "position_z_m"});
    if (position_m && *position_m > position_max_m)
        return fmt::format("the position is {:.1f} km from ground's own solution of that epoch; the limit is {:g} km",
                           *position_m * 1e-3, position_max_m * 1e-3);
    const auto velocity_mps = distance(arguments, solution, {"velocity_x_mps", "velocity_y_mps", "velocity_z_mps"});
    if (velocity_mps && *velocity_mps > velocity_max_mps)
        return fmt::format(
            "the velocity differs by {:.2f} m/s from ground's own solution of that epoch; the limit is {:g} m/s",
            *velocity_mps, velocity_max_mps);
    const auto target_m = target_distance_m(arguments, solution);
    if (target_m && *target_m > target_moved_max_m)
        return fmt::format("the target is {:.1f} km from that of ground's solution; the limit is {:g} km",
                           *target_m * 1e-3, target_moved_max_m * 1e-3);
    const auto radius_m = value_of(arguments, "target_radius_m"), own_radius_m = value_of(solution, "target_radius_m");
    if (radius_m && own_radius_m && std::abs(*radius_m - *own_radius_m) > radius_moved_max_m)
        return fmt::format("target_radius_m is {:.1f} km from that of ground's solution; the limit is {:g} km",
                           std::abs(*radius_m - *own_radius_m) * 1e-3, radius_moved_max_m * 1e-3);
    return {};
}

}  // namespace

SolutionJudge::SolutionJudge(std::vector<NamedValue> solution) : solutions_{std::move(solution)} {}

void SolutionJudge::renew(std::vector<NamedValue> solution) {
    solutions_.push_back(std::move(solution));
}

std::string SolutionJudge::judge(std::span<const NamedValue> arguments) const {
    const auto epoch = value_of(arguments, "epoch_sclk");
    if (!epoch || latest().empty()) return {};
    std::string why = fmt::format("epoch_sclk {} is of no navigation solution that ground has", *epoch);
    for (const auto& solution : solutions_) {
        const auto other = value_of(solution, "epoch_sclk");
        if (!other || std::abs(*other - *epoch) > same_epoch_s) continue;
        why = difference_of(solution, arguments);
        if (why.empty()) break;
    }
    return why;
}

}  // namespace aeolis::commands
