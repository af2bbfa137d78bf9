// SPDX-License-Identifier: Apache-2.0
#include "simulation/entry_flight.hpp"

#include "simulation/vehicle/aeroshell.hpp"

namespace aeolis::simulation {

PointMass nominal_entry(const Scenario& scenario) {
    const EntryState& entry = scenario.entry;
    PointMass at;
    at.p_MoB_M = place(entry.latitude_deg * degree_rad, entry.longitude_deg * degree_rad, entry.radius_m);
    const Horizon local = horizon(at.p_MoB_M);
    const double flight_path_rad = entry.flight_path_deg * degree_rad;
    const double azimuth_rad = entry.azimuth_deg * degree_rad;
    at.v_MB_M = entry.speed_mps * (std::sin(flight_path_rad) * local.up +
                                   std::cos(flight_path_rad) *
                                       (std::cos(azimuth_rad) * local.north + std::sin(azimuth_rad) * local.east));
    return at;
}

Vector3 lift_direction(const Vector3& p, const Vector3& v, double bank_rad) {
    const Vector3 forward = v.normalized();
    const Vector3 up = p.normalized();
    const Vector3 right = forward.cross(up).normalized();
    return std::cos(bank_rad) * right.cross(forward) + std::sin(bank_rad) * right;
}

EntryFlight::EntryFlight(const Scenario& scenario)
    : atmosphere_(scenario.density_scale, scenario.air), landing_radius_m_(scenario.target.radius_m),
      mass_kg_(scenario.masses.entry_kg), aero_scale_(scenario.aero_scale) {}

Sensed EntryFlight::sensed(const PointMass& at) const {
    const Air air = atmosphere_.at(altitude_m(at));
    const double speed_mps = at.v_MB_M.norm();
    const double mach = speed_mps / air.speed_of_sound_mps;
    const AeroCoefficients coefficients = scaled(aeroshell_coefficients(mach, trim_angle_rad(mach)), aero_scale_, mach);
    const double scale_mps2 = 0.5 * air.density_kgm3 * speed_mps * speed_mps * aeroshell_area_m2 / mass_kg_;
    return {coefficients.drag * scale_mps2, coefficients.lift * scale_mps2, mach};
}

Vector3 EntryFlight::specific_force(const PointMass& at, double bank_rad) const {
    const Sensed by = sensed(at);
    return -by.drag_mps2 * at.v_MB_M.normalized() + by.lift_mps2 * lift_direction(at.p_MoB_M, at.v_MB_M, bank_rad);
}

PointMass EntryFlight::step(const PointMass& at, double bank_rad, double step_s) const {
    return runge_kutta_step(at, step_s, [&](double, const Vector3& p, const Vector3& v) -> Vector3 {
        return specific_force({p, v}, bank_rad);
    });
}

}  // namespace aeolis::simulation
