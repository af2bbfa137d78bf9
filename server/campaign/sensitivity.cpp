// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/sensitivity.hpp"

#include "simulation/mars/atmosphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace aeolis::server::campaign {
namespace {

using simulation::Dispersions;

struct ErrorField {
    const char* name;
    const char* group;
    double Dispersions::* member;
};

constexpr std::array error_fields{
    ErrorField{"delivery_flight_path_deg", "delivery", &Dispersions::delivery_flight_path_deg},
    ErrorField{"delivery_position_m", "delivery", &Dispersions::delivery_position_m},
    ErrorField{"knowledge_position_m", "knowledge", &Dispersions::knowledge_position_m},
    ErrorField{"knowledge_velocity_mps", "knowledge", &Dispersions::knowledge_velocity_mps},
    ErrorField{"attitude_rad", "attitude", &Dispersions::attitude_rad},
    ErrorField{"imu_bias_mps2", "imu", &Dispersions::imu_bias_mps2},
    ErrorField{"gyro_bias_rps", "imu", &Dispersions::gyro_bias_rps},
    ErrorField{"imu_misalignment_rad", "imu", &Dispersions::imu_misalignment_rad},
    ErrorField{"imu_scale_fraction", "imu", &Dispersions::imu_scale_fraction},
    ErrorField{"gyro_scale_fraction", "imu", &Dispersions::gyro_scale_fraction},
    ErrorField{"imu_noise_mps", "imu", &Dispersions::imu_noise_mps},
    ErrorField{"gyro_noise_rad", "imu", &Dispersions::gyro_noise_rad},
    ErrorField{"density_fraction", "density", &Dispersions::density_fraction},
    ErrorField{"density_aloft_fraction", "density", &Dispersions::density_aloft_fraction},
    ErrorField{"drag_fraction", "drag", &Dispersions::drag_fraction},
    ErrorField{"slow_drag_fraction", "drag", &Dispersions::slow_drag_fraction},
    ErrorField{"mass_fraction", "mass", &Dispersions::mass_fraction},
    ErrorField{"wind_mps", "wind", &Dispersions::wind_mps},
    ErrorField{"gust_mps", "wind", &Dispersions::gust_mps},
    ErrorField{"parachute_drag_fraction", "parachute", &Dispersions::parachute_drag_fraction},
    ErrorField{"parachute_plane_deg", "parachute", &Dispersions::parachute_plane_deg},
    ErrorField{"parachute_oscillation_fraction", "parachute", &Dispersions::parachute_oscillation_fraction},
    ErrorField{"radar_range_fraction", "radar", &Dispersions::radar_range_fraction},
    ErrorField{"radar_velocity_mps", "radar", &Dispersions::radar_velocity_mps},
    ErrorField{"radar_dropout_fraction", "radar", &Dispersions::radar_dropout_fraction},
    ErrorField{"radar_sand_mps", "radar", &Dispersions::radar_sand_mps},
    ErrorField{"terrain_height_m", "terrain", &Dispersions::terrain_height_m},
    ErrorField{"terrain_slope_deg", "terrain", &Dispersions::terrain_slope_deg},
    ErrorField{"terrain_roughness_m", "terrain", &Dispersions::terrain_roughness_m},
};
static_assert(sizeof(Dispersions) == error_fields.size() * sizeof(double), "an error belongs to no group");

/// The deviations of density by height, where there are any, stand for those of the group "density".
constexpr const char* density_by_height = "density_by_height";

double spread_of(const Moments& of) {
    return of.count() < 2 ? unknown : of.deviation();
}

double deviation_of(const CaseTable& table, std::string_view name) {
    const CaseTable::Column* column = table.column(name);
    Moments spread;
    for (std::size_t i = 0; column != nullptr && i < column->values.size(); ++i)
        if (!std::isnan(column->values[i])) spread.add(column->values[i]);
    return spread_of(spread);
}

/// Of what too few landings show: `otherwise`.
std::string shown(double value, int digits, std::string_view otherwise) {
    return std::isnan(value) ? std::string{otherwise} : fmt::format("{:.{}f}", value, digits);
}

/// What a table or a file shows of an influence, in its order.
struct ShownFigure {
    const char* heading;
    const char* csv;
    int digits;
    double scale;
    double (*value)(const Influence&);
};

constexpr std::array shown_figures{
    ShownFigure{"along km", "along_sigma_km", 3, km, [](const Influence& one) { return one.along_m; }},
    ShownFigure{"across km", "across_sigma_km", 3, km, [](const Influence& one) { return one.across_m; }},
    ShownFigure{"Mach", "parachute_mach_sigma", 4, 1.0, [](const Influence& one) { return one.parachute_mach; }},
    ShownFigure{"q Pa", "parachute_pressure_sigma_Pa", 1, 1.0,
                [](const Influence& one) { return one.parachute_pressure_Pa; }},
    ShownFigure{"peak m/s2", "peak_deceleration_sigma_mps2", 2, 1.0,
                [](const Influence& one) { return one.peak_deceleration_mps2; }},
    ShownFigure{"prop. kg", "propellant_sigma_kg", 2, 1.0, [](const Influence& one) { return one.propellant_kg; }},
    ShownFigure{"down m/s", "vertical_sigma_mps", 4, 1.0, [](const Influence& one) { return one.vertical_mps; }},
    ShownFigure{"level m/s", "horizontal_sigma_mps", 4, 1.0, [](const Influence& one) { return one.horizontal_mps; }},
};

}  // namespace

const std::vector<ErrorGroup>& error_groups() {
    static const std::vector<ErrorGroup> groups = [] {
        std::vector<ErrorGroup> made;
        for (const ErrorField& field : error_fields) {
            if (made.empty() || made.back().name != field.group) made.push_back({field.group, {}});
            made.back().fields.emplace_back(field.name);
        }
        return made;
    }();
    return groups;
}

std::vector<ErrorGroup> single_errors(const simulation::Scenario& scenario) {
    std::vector<ErrorGroup> singles;
    const bool by_height = simulation::has_deviations(scenario.density_scale);
    if (by_height) singles.push_back({density_by_height, {density_by_height}});
    for (const ErrorField& field : error_fields)
        if (scenario.dispersions.*field.member != 0.0 && !(by_height && std::string_view{field.group} == "density"))
            singles.push_back({field.name, {field.name}});
    return singles;
}

simulation::Scenario with_errors(const simulation::Scenario& scenario, const ErrorGroup& group) {
    simulation::Scenario only = simulation::undispersed(scenario);
    only.name += "-" + group.name;
    for (const ErrorField& field : error_fields)
        if (std::ranges::find(group.fields, field.name) != group.fields.end())
            only.dispersions.*field.member = scenario.dispersions.*field.member;
    const auto has = [&](std::string_view name) { return std::ranges::find(group.fields, name) != group.fields.end(); };
    if (has(density_by_height) || has("density_fraction")) only.density_scale = scenario.density_scale;
    return only;
}

Influence influence_of(const std::string& group, const CaseTable& table, double course_deg) {
    Influence found;
    found.group = group;
    found.cases = table.numbers.size();
    found.landed = static_cast<std::uint64_t>(std::ranges::count(table.outcomes, "touchdown"));
    const CaseTable::Column* east = table.column("east_m");
    const CaseTable::Column* north = table.column("north_m");
    const double course_rad = course_deg * std::numbers::pi / 180.0;
    Moments along, across;
    PlaneMoments plane;
    for (std::size_t i = 0; east != nullptr && north != nullptr && i < east->values.size(); ++i) {
        const double e = east->values[i], n = north->values[i];
        if (std::isnan(e) || std::isnan(n)) continue;
        along.add(e * std::sin(course_rad) + n * std::cos(course_rad));
        across.add(e * std::cos(course_rad) - n * std::sin(course_rad));
        plane.add(e, n);
    }
    found.along_m = spread_of(along);
    found.across_m = spread_of(across);
    if (plane.count() >= 2) found.ellipse = plane.ellipse_99();
    found.vertical_mps = deviation_of(table, "vertical_mps");
    found.horizontal_mps = deviation_of(table, "horizontal_mps");
    found.propellant_kg = deviation_of(table, "propellant_kg");
    found.parachute_mach = deviation_of(table, "parachute_mach");
    found.parachute_pressure_Pa = deviation_of(table, "parachute_pressure_Pa");
    found.peak_deceleration_mps2 = deviation_of(table, "peak_deceleration_mps2");
    if (const CaseTable::Column* left = table.column("propellant_kg"); left != nullptr)
        for (const double kg : left->values)
            if (!std::isnan(kg) && !(kg >= found.propellant_least_kg)) found.propellant_least_kg = kg;
    return found;
}

std::string sensitivity_table(const std::vector<Influence>& influences, const Influence& all) {
    std::string text = fmt::format("{:<26}{:>8}", "one standard deviation", "landed");
    for (const ShownFigure& figure : shown_figures) text += fmt::format("{:>10}", figure.heading);
    text += fmt::format("{:>17}{:>10}\n", "99 % ellipse km", "least kg");
    const auto numbers = [&](const std::string& name, const std::string& landed, const auto& value) {
        text += fmt::format("{:<26}{:>8}", name, landed);
        for (const ShownFigure& figure : shown_figures)
            text += fmt::format("{:>10}", shown(figure.scale * value(figure), figure.digits, "-"));
    };
    const auto row = [&](const std::string& name, const Influence& one) {
        numbers(name, fmt::format("{}/{}", one.landed, one.cases),
                [&](const ShownFigure& figure) { return figure.value(one); });
        const auto axes = one.ellipse
                              ? fmt::format("{:.2f} x {:.2f}", one.ellipse->major_m * km, one.ellipse->minor_m * km)
                              : std::string{"-"};
        text += fmt::format("{:>17}{:>10}\n", axes, shown(one.propellant_least_kg, 1, "-"));
    };
    std::vector<Influence> ordered = influences;
    std::ranges::stable_sort(ordered, std::ranges::greater{}, [](const Influence& one) {
        return std::isnan(one.along_m) ? -1.0 : one.along_m;  // the unknown last
    });
    for (const Influence& one : ordered) row(one.group, one);
    numbers("root of sum of squares", "", [&](const ShownFigure& figure) {
        double squares = 0.0;
        for (const Influence& one : ordered) squares += figure.value(one) * figure.value(one);
        return std::sqrt(squares);
    });
    text += '\n';
    row("all errors at once", all);
    return text;
}

std::string sensitivity_csv(const std::vector<Influence>& influences, const Influence& all) {
    std::string text = "errors,cases,landed";
    for (const ShownFigure& figure : shown_figures) text += fmt::format(",{}", figure.csv);
    text += ",ellipse_major_km,ellipse_minor_km,ellipse_azimuth_deg,propellant_least_kg\n";
    const auto row = [&](const Influence& one) {
        text += fmt::format("{},{},{}", one.group, one.cases, one.landed);
        for (const ShownFigure& figure : shown_figures)
            text += "," + shown(figure.scale * figure.value(one), figure.digits + 2, "");
        text += one.ellipse ? fmt::format(",{:.4f},{:.4f},{:.2f}", one.ellipse->major_m * km, one.ellipse->minor_m * km,
                                          one.ellipse->azimuth_deg)
                            : std::string{",,,"};
        text += "," + shown(one.propellant_least_kg, 2, "") + '\n';
    };
    for (const Influence& one : influences) row(one);
    row(all);
    return text;
}

}  // namespace aeolis::server::campaign
