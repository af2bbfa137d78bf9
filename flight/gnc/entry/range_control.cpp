// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/range_control.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

namespace {

double between(double a, double b, double part) {
    return a + part * (b - a);
}

}  // namespace

EntryReferenceRow reference_at(const EntryReference& reference, double velocity_mps) {
    AEOLIS_CHECK(reference.row_count <= reference.rows.size());
    if (reference.row_count == 0) return {};
    const EntryReferenceRow* const rows = reference.rows.data();
    const EntryReferenceRow* const end = rows + reference.row_count;
    const EntryReferenceRow* const above = std::upper_bound(
        rows, end, velocity_mps, [](double v, const EntryReferenceRow& row) { return v < row.velocity_mps; });
    if (above == rows) return rows[0];
    if (above == end) return end[-1];
    const EntryReferenceRow& a = above[-1];
    const EntryReferenceRow& b = above[0];
    AEOLIS_CHECK(a.velocity_mps < b.velocity_mps);  // the load has them in this order
    const double part = (velocity_mps - a.velocity_mps) / (b.velocity_mps - a.velocity_mps);
    EntryReferenceRow row;
    row.velocity_mps = velocity_mps;
    row.range_to_go_m = between(a.range_to_go_m, b.range_to_go_m, part);
    row.drag_mps2 = between(a.drag_mps2, b.drag_mps2, part);
    row.altitude_rate_mps = between(a.altitude_rate_mps, b.altitude_rate_mps, part);
    row.d_range_d_drag_s2 = between(a.d_range_d_drag_s2, b.d_range_d_drag_s2, part);
    row.d_range_d_altitude_rate_s = between(a.d_range_d_altitude_rate_s, b.d_range_d_altitude_rate_s, part);
    row.d_range_d_lift_to_drag_m = between(a.d_range_d_lift_to_drag_m, b.d_range_d_lift_to_drag_m, part);
    row.lift_to_drag = between(a.lift_to_drag, b.lift_to_drag, part);
    return row;
}

RangeControlOutput range_control(const Parameters& parameters, const EntryReference& reference,
                                 const RangeControlInput& input) {
    const EntryReferenceRow row = reference_at(reference, input.velocity_mps);
    RangeControlOutput out;
    out.predicted_range_m = row.range_to_go_m + row.d_range_d_drag_s2 * (input.drag_mps2 - row.drag_mps2) +
                            row.d_range_d_altitude_rate_s * (input.altitude_rate_mps - row.altitude_rate_mps);
    const double sensitivity_m = std::max(row.d_range_d_lift_to_drag_m, parameters.guidance_sensitivity_min_m);
    out.vertical_lift_to_drag =
        row.lift_to_drag + parameters.guidance_gain * (input.range_to_go_m - out.predicted_range_m) / sensitivity_m;
    const double cosine = out.vertical_lift_to_drag / input.lift_to_drag;
    out.saturated = std::abs(cosine) > parameters.guidance_saturation;
    out.bank_magnitude_rad = std::acos(std::clamp(cosine, -1.0, 1.0));
    return out;
}

}  // namespace aeolis::flight::gnc
