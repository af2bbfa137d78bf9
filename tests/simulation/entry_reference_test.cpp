// SPDX-License-Identifier: Apache-2.0
#include "generated/dictionary_flight.hpp"
#include "simulation/entry_flight.hpp"
#include "simulation/entry_reference.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace simulation_entry_reference_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

/// The reference flown anew, independent of the generator's adjoint: RK4 in three dimensions at 0.1 s with the
/// tabulated vertical lift-to-drag against velocity (plus `more_lift`), from a state that is disturbed at `from_mps`.
struct Disturbance {
    double altitude_m = 0.0, flight_path_rad = 0.0, lift_to_drag = 0.0;
};
struct Flown {
    double range_m = 0.0;                             ///< from the disturbance to the end of the reference
    double drag_mps2 = 0.0, altitude_rate_mps = 0.0;  ///< just after the disturbance
};

double vertical_lift(const flight::EntryReference& reference, double v) {
    const auto* rows = reference.rows.data();
    std::size_t i = 1;
    while (i + 1 < reference.row_count && rows[i].velocity_mps < v) ++i;
    const double part =
        std::clamp((v - rows[i - 1].velocity_mps) / (rows[i].velocity_mps - rows[i - 1].velocity_mps), 0.0, 1.0);
    return rows[i - 1].lift_to_drag + part * (rows[i].lift_to_drag - rows[i - 1].lift_to_drag);
}

Flown fly(const Scenario& scenario, const flight::EntryReference& reference, double from_mps,
          const Disturbance& disturbance) {
    const EntryFlight flight(scenario);
    PointMass at = nominal_entry(scenario);
    const double end_mps = reference.rows[0].velocity_mps;
    const double top_mps = reference.rows[reference.row_count - 1].velocity_mps;
    bool disturbed = false, slowing = false;
    double before_mps = 0.0;
    Flown flown;
    for (int i = 0; i < 20000; ++i) {
        const double v = at.v_MB_M.norm();
        slowing = slowing || (v >= top_mps - 0.5 && v < before_mps);
        before_mps = v;
        if (slowing && !disturbed && v <= from_mps) {
            disturbed = true;
            at.p_MoB_M += disturbance.altitude_m * at.p_MoB_M.normalized();
            const Vector3 right = at.v_MB_M.cross(at.p_MoB_M).normalized();
            at.v_MB_M = Eigen::AngleAxisd(disturbance.flight_path_rad, right) * at.v_MB_M;
            flown.drag_mps2 = flight.sensed(at).drag_mps2;
            flown.altitude_rate_mps = at.v_MB_M.dot(at.p_MoB_M.normalized());
        }
        if (disturbed && v <= end_mps) break;
        const double u = slowing ? vertical_lift(reference, v) + (disturbed ? disturbance.lift_to_drag : 0.0)
                                 : flight.sensed(at).lift_mps2 / flight.sensed(at).drag_mps2 *
                                       std::cos(reference_bank_rad(scenario, 9e3, 0.0));
        const PointMass next = runge_kutta_step(at, 0.1, [&](double, const Vector3& p, const Vector3& w) -> Vector3 {
            const double drag = flight.sensed({p, w}).drag_mps2;
            return -drag * w.normalized() + u * drag * lift_direction(p, w, 0.0);
        });
        if (disturbed)
            flown.range_m += scenario.target.radius_m *
                             std::acos(std::min(1.0, at.p_MoB_M.normalized().dot(next.p_MoB_M.normalized())));
        at = next;
    }
    return flown;
}

}  // namespace

TEST_CASE("the reference is in the order that guidance needs, and ends at the target", "[gnc][R27]") {
    const flight::EntryReference reference = make_entry_reference(Scenario{});
    REQUIRE(reference.row_count == 64);
    for (std::uint32_t i = 1; i < reference.row_count; ++i) {
        CHECK(reference.rows[i].velocity_mps > reference.rows[i - 1].velocity_mps);
        CHECK(reference.rows[i].range_to_go_m > reference.rows[i - 1].range_to_go_m);
    }
    // OD137: 14.5 km to go at E+239 and 453 m/s; 243 km at 5114 m/s [od137]
    CHECK(reference.rows[0].velocity_mps == Approx(453.0).margin(1.0));
    CHECK(reference.rows[0].range_to_go_m == Approx(14500.0).margin(1500.0));
}

TEST_CASE("the reference's bank has its corners where the scenario puts them", "[gnc][R27]") {
    Scenario scenario;
    scenario.parameters.bank_before_guidance_deg = 70.0;
    scenario.guidance.reference_turn_mps = 5000.0;
    scenario.guidance.reference_held_from_mps = 4000.0;
    scenario.guidance.reference_held_to_mps = 1200.0;
    scenario.guidance.reference_up_mps = 1000.0;
    const auto bank_deg = [&](double speed_mps) {
        return reference_bank_rad(scenario, speed_mps, 50.0 * degree_rad) / degree_rad;
    };
    CHECK(bank_deg(5000.0) == Approx(70.0));
    CHECK(bank_deg(4500.0) == Approx(60.0));
    CHECK(bank_deg(4000.0) == Approx(50.0));
    CHECK(bank_deg(1200.0) == Approx(50.0));
    CHECK(bank_deg(1100.0) == Approx(25.0));
    CHECK(bank_deg(1000.0) == 0.0);
}

TEST_CASE("the reference of a vehicle that fires by range ends its lead before that range, and meets the target",
          "[gnc][R27]") {
    Scenario scenario;
    scenario.parameters.parachute_range_m = 9000.0;
    scenario.parachute_speed_mps = 380.0;
    const flight::EntryReference by_range = make_entry_reference(scenario);
    REQUIRE(by_range.row_count == 64);
    const auto& end = by_range.rows[0];
    const double level_mps =
        std::sqrt(end.velocity_mps * end.velocity_mps - end.altitude_rate_mps * end.altitude_rate_mps);
    const double lead_m = scenario.parameters.sufr_lead_s * level_mps;
    CHECK(end.range_to_go_m == Approx(9000.0 + lead_m).margin(0.25 * end.velocity_mps));
    CHECK(end.velocity_mps > scenario.parachute_speed_mps + scenario.guidance.reference_end_mps);
}

TEST_CASE("its peak of drag is that of the published entry within five percent", "[gnc][R27]") {
    const flight::EntryReference reference = make_entry_reference(Scenario{});
    double peak_mps2 = 0.0;
    for (const auto& row : reference.rows) peak_mps2 = std::max(peak_mps2, row.drag_mps2);
    CHECK(peak_mps2 == Approx(120.0).epsilon(0.05));
}

TEST_CASE("its partials are what re-flown disturbances give", "[gnc][R27]") {
    const Scenario scenario;
    const flight::EntryReference reference = make_entry_reference(scenario);
    for (const std::uint32_t i : {20u, 30u, 40u, 50u, 58u}) {
        const auto& row = reference.rows[i];
        INFO("row of " << row.velocity_mps << " m/s");
        const double v = row.velocity_mps;
        const Flown low = fly(scenario, reference, v, {-100.0, 0.0, 0.0}),
                    high = fly(scenario, reference, v, {100.0, 0.0, 0.0});
        CHECK((high.range_m - low.range_m) / (high.drag_mps2 - low.drag_mps2) ==
              Approx(row.d_range_d_drag_s2).epsilon(0.10));
        const Flown down = fly(scenario, reference, v, {0.0, -2e-3, 0.0}),
                    up = fly(scenario, reference, v, {0.0, 2e-3, 0.0});
        CHECK((up.range_m - down.range_m) / (up.altitude_rate_mps - down.altitude_rate_mps) ==
              Approx(row.d_range_d_altitude_rate_s).epsilon(0.10));
        const Flown less = fly(scenario, reference, v, {0.0, 0.0, -2e-3}),
                    more = fly(scenario, reference, v, {0.0, 0.0, 2e-3});
        CHECK((more.range_m - less.range_m) / 4e-3 == Approx(row.d_range_d_lift_to_drag_m).epsilon(0.10));
    }
}

TEST_CASE("a nearer target is reached by more bank", "[gnc][R27]") {
    Scenario near;
    near.target.longitude_deg -= 0.5;  // 30 km
    const auto usual = make_entry_reference(Scenario{}), nearer = make_entry_reference(near);
    const auto middle = [](const flight::EntryReference& r) { return r.rows[35].lift_to_drag; };
    CHECK(middle(nearer) < middle(usual));
}

}  // namespace simulation_entry_reference_test
