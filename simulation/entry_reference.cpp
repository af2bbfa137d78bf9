// SPDX-License-Identifier: Apache-2.0
#include "simulation/entry_reference.hpp"

#include "simulation/entry_flight.hpp"
#include "simulation/mars/mars.hpp"
#include "simulation/vehicle/aeroshell.hpp"
#include "simulation/vehicle/parachute.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace aeolis::simulation {

namespace {

constexpr double step_s = 0.25;
constexpr double descent_step_s = 0.05;  // a parachute that opens a step later lands 20 m farther
constexpr double longest_s = 900.0;
constexpr double least_deceleration_mps2 = 0.5;  // below this, velocity is no independent variable

/// One point of the reference flight, in the plane of flight.
struct Node {
    double velocity_mps, flight_path_rad, altitude_m, radius_m, ground_m;
    double drag_mps2, lift_to_drag, vertical_lift_to_drag;
    double coriolis_rps;  ///< rate of the flight path angle due to Mars's spin
};

/// Derivatives with respect to velocity.
struct Rates {
    double altitude_s, flight_path_radspm, ground_s;
};

double azimuth_rad(const PointMass& at) {
    const Horizon local = horizon(at.p_MoB_M);
    return std::atan2(at.v_MB_M.dot(local.east), at.v_MB_M.dot(local.north));
}

Node node_of(const EntryFlight& flight, const PointMass& at, double ground_m, double bank_rad) {
    const Sensed sensed = flight.sensed(at);
    Node node;
    node.velocity_mps = at.v_MB_M.norm();
    node.radius_m = at.p_MoB_M.norm();
    node.altitude_m = flight.altitude_m(at);
    node.flight_path_rad = std::asin(at.v_MB_M.dot(at.p_MoB_M) / (node.velocity_mps * node.radius_m));
    node.ground_m = ground_m;
    node.drag_mps2 = sensed.drag_mps2;
    node.lift_to_drag = sensed.lift_mps2 / std::max(sensed.drag_mps2, 1.0e-12);
    node.vertical_lift_to_drag = node.lift_to_drag * std::cos(bank_rad);
    node.coriolis_rps = 2.0 * mars_spin_rps * std::cos(latitude_rad(at.p_MoB_M)) * std::sin(azimuth_rad(at));
    return node;
}

/// Derivatives of the remaining range R by the state at a node.
struct Costate {
    double altitude = 0.0;        ///< ∂R/∂h
    double flight_path_m = 0.0;   ///< ∂R/∂γ
    double lift_to_drag_m = 0.0;  ///< ∂R/∂u
};

/// The reference flight and the descent after it.
struct Flight {
    std::vector<Node> nodes;  ///< from where it slows down to the start of SUFR
    double ground_at_end_m = 0.0;
    double after_m = 0.0;  ///< along the ground from the start of SUFR to the landing
    PointMass end;         ///< state at the start of SUFR
};

double ground_step_m(const PointMass& before, const PointMass& after, double target_radius_m) {
    const Vector3 a = before.p_MoB_M.normalized(), b = after.p_MoB_M.normalized();
    return target_radius_m * std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Range from the start of SUFR: straightening up, the parachute, and the sidestep of the powered approach.
/// @param to_aim_m  along the ground from `at` to where guidance aims
double range_after_entry_m(const Scenario& scenario, const Atmosphere& atmosphere, PointMass at, double to_aim_m) {
    const Masses& masses = scenario.masses;
    const flight::Parameters& plan = scenario.parameters;
    double mass_kg = masses.entry_kg - 6.0 * masses.entry_balance_each_kg;
    bool heatshield = true;
    double ground_m = 0.0, since_mortar_s = -1.0;
    const Vector3 right_M = level_right(at.p_MoB_M, at.v_MB_M);
    for (double t = 0.0; t < longest_s; t += descent_step_s) {
        const double altitude_m = at.p_MoB_M.norm() - scenario.target.radius_m;
        const double speed_mps = at.v_MB_M.norm();
        if (altitude_m <= scenario.backshell_altitude_m) break;
        bool near = to_aim_m - ground_m <= plan.parachute_range_m && plan.parachute_range_m > 0.0;
        if (near) {  // as flight, within the parachute's Mach number and pressure
            const Air air = atmosphere.at(altitude_m);
            near = speed_mps / air.speed_of_sound_mps <= plan.parachute_mach_max &&
                   0.5 * air.density_kgm3 * speed_mps * speed_mps <= plan.parachute_pressure_max_Pa;
        }
        if (since_mortar_s < 0.0 && (near || speed_mps <= scenario.parachute_speed_mps)) since_mortar_s = 0.0;
        if (heatshield && since_mortar_s >= plan.heatshield_delay_min_s && speed_mps <= scenario.heatshield_speed_mps) {
            heatshield = false;
            mass_kg -= masses.heatshield_kg;
        }
        const double straight = std::min(t / plan.sufr_duration_s, 1.0);
        const auto force = [&](double, const Vector3& p, const Vector3& v) -> Vector3 {
            const Air air = atmosphere.at(p.norm() - scenario.target.radius_m);
            const double v_mps = v.norm();
            const double mach = v_mps / air.speed_of_sound_mps;
            const double trim_rad = trim_angle_rad(mach) + straight * (balanced_trim_angle_rad - trim_angle_rad(mach));
            const AeroCoefficients aero = scaled(aeroshell_coefficients(mach, trim_rad), scenario.aero_scale, mach);
            const double pressure_by_mass = 0.5 * air.density_kgm3 * v_mps * v_mps / mass_kg;
            const bool open = since_mortar_s > line_stretch_s;
            if (!open)
                return pressure_by_mass * aeroshell_area_m2 *
                       (-aero.drag * v.normalized() + aero.lift * lift_direction(p, v, 0.0));
            const double area_m2 =
                scenario.parachute_drag_area_m2 * parachute_inflation(since_mortar_s) * parachute_mach_factor(mach);
            const Vector3 forward = v.normalized();
            const Vector3 lift = parachute_lift_direction(forward, right_M, since_mortar_s);
            return pressure_by_mass * area_m2 * (scenario.parachute_lift_to_drag * lift - forward);
        };
        const PointMass next = runge_kutta_step(at, descent_step_s, force);
        ground_m += ground_step_m(at, next, scenario.target.radius_m);
        at = next;
        if (since_mortar_s >= 0.0) since_mortar_s += descent_step_s;
    }
    const Horizon local = horizon(at.p_MoB_M);
    const double level_mps = (at.v_MB_M - at.v_MB_M.dot(local.up) * local.up).norm();
    return ground_m + level_mps * plan.powered_approach_delay_s +
           scenario.guidance.divert_m * std::cos(scenario.guidance.divert_azimuth_deg * degree_rad - azimuth_rad(at));
}

/// Derivatives of range_after_entry_m by the state at the start of SUFR.
Costate range_slopes_after_entry(const Scenario& scenario, const Atmosphere& atmosphere, const PointMass& at,
                                 double to_aim_m) {
    constexpr double dh_m = 200.0, dgamma_rad = 0.5 * degree_rad;
    const Vector3 up = at.p_MoB_M.normalized();
    const auto range_m = [&](double h_m, double gamma_rad) {
        const Vector3 v = std::cos(gamma_rad) * at.v_MB_M +
                          std::sin(gamma_rad) * at.v_MB_M.norm() * lift_direction(at.p_MoB_M, at.v_MB_M, 0.0);
        return range_after_entry_m(scenario, atmosphere, {at.p_MoB_M + h_m * up, v}, to_aim_m);
    };
    return {(range_m(dh_m, 0.0) - range_m(-dh_m, 0.0)) / (2.0 * dh_m),
            (range_m(0.0, dgamma_rad) - range_m(0.0, -dgamma_rad)) / (2.0 * dgamma_rad), 0.0};
}

/// @param range_m  along the ground from entry to where guidance aims
Flight fly(const Scenario& scenario, const EntryFlight& flight, const Atmosphere& atmosphere, double range_m,
           double held_rad) {
    Flight result;
    const flight::Parameters& plan = scenario.parameters;
    const double end_mps = scenario.parachute_speed_mps + scenario.guidance.reference_end_mps;
    PointMass at = nominal_entry(scenario);
    double ground_m = 0.0;
    bool slowing = false;
    for (double t = 0.0; t < longest_s; t += step_s) {
        const double speed_mps = at.v_MB_M.norm();
        const double bank_rad =
            slowing ? reference_bank_rad(scenario, speed_mps, held_rad) : plan.bank_before_guidance_deg * degree_rad;
        const Sensed sensed = flight.sensed(at);
        const double climb_mps2 = free_fall(at.p_MoB_M, at.v_MB_M).dot(at.v_MB_M) / speed_mps;
        slowing = slowing || sensed.drag_mps2 - climb_mps2 >= least_deceleration_mps2;
        if (slowing) result.nodes.push_back(node_of(flight, at, ground_m, bank_rad));
        const bool near = plan.parachute_range_m > 0.0 && speed_mps <= plan.sufr_low_speed_mps &&
                          range_m - ground_m <= plan.parachute_range_m +
                                                    plan.sufr_lead_s * at.v_MB_M.cross(at.p_MoB_M.normalized()).norm();
        if (near || speed_mps <= end_mps || flight.altitude_m(at) <= scenario.backshell_altitude_m) break;
        const double upright = std::cos(bank_rad);
        const PointMass next = runge_kutta_step(at, step_s, [&](double, const Vector3& p, const Vector3& v) -> Vector3 {
            const Sensed by = flight.sensed({p, v});
            return -by.drag_mps2 * v.normalized() + upright * by.lift_mps2 * lift_direction(p, v, 0.0);
        });
        ground_m += ground_step_m(at, next, scenario.target.radius_m);
        at = next;
    }
    result.ground_at_end_m = ground_m;
    result.after_m = range_after_entry_m(scenario, atmosphere, at, range_m - ground_m);
    result.end = at;
    return result;
}

/// F and G at an offset (altitude, flight path angle, vertical lift-to-drag) from a node.
Rates rates(const Node& node, double scale_height_m, double target_radius_m, double d_altitude_m,
            double d_flight_path_rad, double d_lift_to_drag) {
    const double v = node.velocity_mps;
    const double r = node.radius_m + d_altitude_m;
    const double gamma = node.flight_path_rad + d_flight_path_rad;
    const double g = mars_gm_m3ps2 / (r * r);
    const double drag = node.drag_mps2 * std::exp(-d_altitude_m / scale_height_m);
    const double lift_up = (node.vertical_lift_to_drag + d_lift_to_drag) * drag;
    const double v_rate = -drag - g * std::sin(gamma);
    const double gamma_rate = lift_up / v + (v / r - g / v) * std::cos(gamma) + node.coriolis_rps;
    return {v * std::sin(gamma) / v_rate, gamma_rate / v_rate, v * std::cos(gamma) * target_radius_m / r / v_rate};
}

Costate costate_rate(const Node& node, double scale_height_m, double target_radius_m, const Costate& at) {
    constexpr double dh = 10.0, dg = 1.0e-4, du = 1.0e-3;
    const auto by = [&](double h, double g, double u) { return rates(node, scale_height_m, target_radius_m, h, g, u); };
    const auto slope = [&](const Rates& plus, const Rates& minus, double step) {
        return -(at.altitude * (plus.altitude_s - minus.altitude_s) +
                 at.flight_path_m * (plus.flight_path_radspm - minus.flight_path_radspm) +
                 (plus.ground_s - minus.ground_s)) /
               (2.0 * step);
    };
    return {slope(by(dh, 0, 0), by(-dh, 0, 0), dh), slope(by(0, dg, 0), by(0, -dg, 0), dg),
            slope(by(0, 0, du), by(0, 0, -du), du)};
}

/// Height in which drag falls by a factor of e at that altitude, from the air itself.
double drag_scale_height_m(const Atmosphere& atmosphere, double altitude_m) {
    constexpr double dh = 500.0;
    return 2.0 * dh /
           std::log(atmosphere.at(altitude_m - dh).density_kgm3 / atmosphere.at(altitude_m + dh).density_kgm3);
}

/// The measure that spaces the rows evenly, counted from the end of the flight.
///
/// Velocity, range and the logarithm of drag have a third each. Rows even in velocity alone left 100 km of range and a
/// factor of 17 in drag between the first two, so that guidance saw errors of 30 km that were not there.
std::vector<double> row_measure(const std::vector<Node>& nodes) {
    const auto range_m = [&](std::size_t i) { return nodes[i].ground_m; };
    const auto log_drag = [&](std::size_t i) { return std::log(std::max(nodes[i].drag_mps2, 0.1)); };
    double all_log_drag = 0.0;
    for (std::size_t i = 1; i < nodes.size(); ++i) all_log_drag += std::abs(log_drag(i) - log_drag(i - 1));
    const double all_mps = nodes.front().velocity_mps - nodes.back().velocity_mps;
    const double all_m = range_m(nodes.size() - 1) - range_m(0);
    std::vector<double> measure(nodes.size(), 0.0);
    for (std::size_t i = nodes.size() - 1; i > 0; --i)
        measure[i - 1] = measure[i] + (nodes[i - 1].velocity_mps - nodes[i].velocity_mps) / all_mps +
                         (range_m(i) - range_m(i - 1)) / all_m + std::abs(log_drag(i) - log_drag(i - 1)) / all_log_drag;
    return measure;
}

}  // namespace

double reference_bank_rad(const Scenario& scenario, double velocity_mps, double held_rad) {
    const Guidance& corners = scenario.guidance;
    const double before_rad = scenario.parameters.bank_before_guidance_deg * degree_rad;
    if (velocity_mps >= corners.reference_turn_mps) return before_rad;
    if (velocity_mps >= corners.reference_held_from_mps) {
        const double part = (velocity_mps - corners.reference_held_from_mps) /
                            (corners.reference_turn_mps - corners.reference_held_from_mps);
        return held_rad + part * (before_rad - held_rad);
    }
    if (velocity_mps >= corners.reference_held_to_mps) return held_rad;
    return held_rad * std::max(velocity_mps - corners.reference_up_mps, 0.0) /
           (corners.reference_held_to_mps - corners.reference_up_mps);
}

flight::EntryReference make_entry_reference(const Scenario& scenario) {
    const EntryFlight flight(scenario);
    const Atmosphere atmosphere(scenario.density_scale, scenario.air);
    const Target aim = aimed_target(scenario);
    const Vector3 target = place(aim.latitude_deg * degree_rad, aim.longitude_deg * degree_rad, aim.radius_m);
    const double wanted_m =
        ground_step_m(nominal_entry(scenario), PointMass{target, Vector3::Zero()}, scenario.target.radius_m);

    // Range falls smoothly with bank, so a few steps of the secant method find it to metres.
    constexpr double most_bank_rad = 100.0 * degree_rad;
    double before_rad = 35.0 * degree_rad, held_rad = 50.0 * degree_rad;
    Flight best = fly(scenario, flight, atmosphere, wanted_m, before_rad);
    double before_m = best.ground_at_end_m + best.after_m - wanted_m;
    for (int i = 0; i < 6; ++i) {
        best = fly(scenario, flight, atmosphere, wanted_m, held_rad);
        const double over_m = best.ground_at_end_m + best.after_m - wanted_m;
        if (std::abs(over_m) < 10.0 || over_m == before_m) break;
        const double next_rad = held_rad - over_m * (held_rad - before_rad) / (over_m - before_m);
        before_rad = held_rad;
        before_m = over_m;
        held_rad = std::clamp(next_rad, 0.0, most_bank_rad);
    }

    // Integrates backwards along the flight by Heun's method.
    const std::vector<Node>& nodes = best.nodes;
    std::vector<Costate> costates(nodes.size());
    costates.back() = range_slopes_after_entry(scenario, atmosphere, best.end, wanted_m - best.ground_at_end_m);
    const double radius_m = scenario.target.radius_m;
    for (std::size_t i = nodes.size() - 1; i > 0; --i) {
        const double dv = nodes[i - 1].velocity_mps - nodes[i].velocity_mps;
        const double h1 = drag_scale_height_m(atmosphere, nodes[i].altitude_m);
        const double h0 = drag_scale_height_m(atmosphere, nodes[i - 1].altitude_m);
        const Costate& at = costates[i];
        const Costate first = costate_rate(nodes[i], h1, radius_m, at);
        const Costate guess{at.altitude + dv * first.altitude, at.flight_path_m + dv * first.flight_path_m,
                            at.lift_to_drag_m + dv * first.lift_to_drag_m};
        const Costate second = costate_rate(nodes[i - 1], h0, radius_m, guess);
        costates[i - 1] = {at.altitude + 0.5 * dv * (first.altitude + second.altitude),
                           at.flight_path_m + 0.5 * dv * (first.flight_path_m + second.flight_path_m),
                           at.lift_to_drag_m + 0.5 * dv * (first.lift_to_drag_m + second.lift_to_drag_m)};
    }

    flight::EntryReference reference;
    if (nodes.size() < 2) return reference;
    const std::vector<double> measure = row_measure(nodes);
    const auto count = static_cast<std::uint32_t>(reference.rows.size());
    std::size_t i = nodes.size() - 1;  // nodes[i] is the slower end of the interval that holds the row's velocity
    for (std::uint32_t row_index = 0; row_index < count; ++row_index) {
        const double wanted = measure.front() * row_index / (count - 1.0);
        while (i > 1 && measure[i - 1] < wanted) --i;
        const Node& a = nodes[i];
        const Node& b = nodes[i - 1];
        const double part = std::clamp((wanted - measure[i]) / (measure[i - 1] - measure[i]), 0.0, 1.0);
        const double v = a.velocity_mps + part * (b.velocity_mps - a.velocity_mps);
        const auto mix = [part](double slow, double fast) { return slow + part * (fast - slow); };
        const double gamma = mix(a.flight_path_rad, b.flight_path_rad);
        const double altitude_m = mix(a.altitude_m, b.altitude_m);
        flight::EntryReferenceRow& row = reference.rows[row_index];
        row.velocity_mps = v;
        row.range_to_go_m = best.ground_at_end_m - mix(a.ground_m, b.ground_m) + best.after_m;
        row.drag_mps2 = mix(a.drag_mps2, b.drag_mps2);
        row.altitude_rate_mps = v * std::sin(gamma);
        row.lift_to_drag = mix(a.vertical_lift_to_drag, b.vertical_lift_to_drag);
        const double d_drag_d_altitude_ps2 = -row.drag_mps2 / drag_scale_height_m(atmosphere, altitude_m);
        row.d_range_d_drag_s2 = mix(costates[i].altitude, costates[i - 1].altitude) / d_drag_d_altitude_ps2;
        row.d_range_d_altitude_rate_s =
            mix(costates[i].flight_path_m, costates[i - 1].flight_path_m) / (v * std::cos(gamma));
        row.d_range_d_lift_to_drag_m = mix(costates[i].lift_to_drag_m, costates[i - 1].lift_to_drag_m);
    }
    reference.row_count = count;
    return reference;
}

}  // namespace aeolis::simulation
