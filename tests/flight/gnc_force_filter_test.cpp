// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/force_filter.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace flight_gnc_force_filter_test {

using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

TEST_CASE("drag and lift of a steady force come out as they are", "[gnc][R27]") {
    ForceFilter filter;
    for (int i = 0; i < 64 * 40; ++i) filter.on(parameters, {-20.0, 3.0, 4.0}, Vector3::UnitX(), 1.0 / 64);
    CHECK(filter.drag_mps2() == Approx(20.0).epsilon(1e-6));
    CHECK(filter.lift_to_drag(parameters, 0.24) == Approx(0.25).epsilon(1e-3));
}

TEST_CASE("a step of drag is two thirds there after one time constant", "[gnc][R27]") {
    ForceFilter filter;
    for (int i = 0; i < 32; ++i)
        filter.on(parameters, {-1.0, 0.0, 0.0}, Vector3::UnitX(), parameters.drag_filter_time_s / 32);
    CHECK(filter.drag_mps2() == Approx(1.0 - std::exp(-1.0)).epsilon(0.02));
}

TEST_CASE("while drag is weak the ratio is what one is told, and never absurd", "[gnc][R27]") {
    ForceFilter filter;
    CHECK(filter.lift_to_drag(parameters, 0.24) == 0.24);
    for (int i = 0; i < 64 * 40; ++i) filter.on(parameters, {-10.0, 9.0, 0.0}, Vector3::UnitX(), 1.0 / 64);
    CHECK(filter.lift_to_drag(parameters, 0.24) == 0.40);
}

}  // namespace flight_gnc_force_filter_test
