// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/range_control.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_range_control_test {

using namespace aeolis::flight;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

EntryReference two_rows() {
    EntryReference reference;
    reference.rows[0] = {1000.0, 80000.0, 15.0, 0.0, -4000.0, 100.0, 40000.0, 0.20};
    reference.rows[1] = {3000.0, 160000.0, 100.0, -300.0, -1000.0, 200.0, 440000.0, 0.16};
    reference.row_count = 2;
    return reference;
}

RangeControlInput on_reference() {
    return {2000.0, 57.5, -150.0, 120000.0, 0.26};
}

}  // namespace

TEST_CASE("rows are linear between and held beyond", "[gnc][R27]") {
    const EntryReference reference = two_rows();
    CHECK(reference_at(reference, 2000.0).range_to_go_m == Approx(120000.0));
    CHECK(reference_at(reference, 2000.0).drag_mps2 == Approx(57.5));
    CHECK(reference_at(reference, 500.0).lift_to_drag == 0.20);
    CHECK(reference_at(reference, 9000.0).lift_to_drag == 0.16);
    CHECK(reference_at(EntryReference{}, 1000.0).range_to_go_m == 0.0);
}

TEST_CASE("on the reference the reference's lift is commanded", "[gnc][R27]") {
    const RangeControlOutput out = range_control(parameters, two_rows(), on_reference());
    CHECK(out.predicted_range_m == Approx(120000.0));
    CHECK(out.vertical_lift_to_drag == Approx(0.18));
    CHECK(std::cos(out.bank_magnitude_rad) == Approx(0.18 / 0.26));
    CHECK_FALSE(out.saturated);
}

TEST_CASE("ten kilometres short of range asks for K times the lift that would give them", "[gnc][R27]") {
    RangeControlInput input = on_reference();
    input.range_to_go_m += 10000.0;
    CHECK(range_control(parameters, two_rows(), input).vertical_lift_to_drag ==
          Approx(0.18 + 5.0 * 10000.0 / 240000.0));
}

TEST_CASE("more drag than the reference shortens the prediction by its partial", "[gnc][R27]") {
    RangeControlInput input = on_reference();
    input.drag_mps2 += 2.0;
    input.altitude_rate_mps += 10.0;
    CHECK(range_control(parameters, two_rows(), input).predicted_range_m ==
          Approx(120000.0 - 2.0 * 2500.0 + 10.0 * 150.0));
}

TEST_CASE("beyond what lift can give bank is full up or full down", "[gnc][R27]") {
    RangeControlInput input = on_reference();
    input.range_to_go_m = 400000.0;
    CHECK(range_control(parameters, two_rows(), input).bank_magnitude_rad == 0.0);
    CHECK(range_control(parameters, two_rows(), input).saturated);
    input.range_to_go_m = 1000.0;
    CHECK(range_control(parameters, two_rows(), input).bank_magnitude_rad == Approx(3.14159265));
}

}  // namespace flight_gnc_range_control_test
