// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/mars.hpp"
#include "flight/gnc/sky_crane/touchdown_logic.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_touchdown_logic_test {

using namespace aeolis::flight::gnc;
using namespace aeolis::flight::gnc::sky_crane;
constexpr aeolis::flight::Parameters parameters;
constexpr auto touchdown_cycles = static_cast<std::uint32_t>(parameters.touchdown_settle_s * 64.0);

namespace {
constexpr double mass_kg = 1970.0, rover_kg = 899.0;
constexpr double stage_N = (mass_kg - rover_kg) * mars_weight_mps2;
}  // namespace

TEST_CASE("a rover on the bridle is no touchdown however long it hangs", "[gnc][R27]") {
    TouchdownLogic logic;
    for (int i = 0; i < 64 * 60; ++i)
        CHECK_FALSE(all_hold(logic.on(parameters, mass_kg * mars_weight_mps2, mass_kg, rover_kg)));
}

TEST_CASE("thrust at the stage's own weight for 1.25 s is touchdown, a cycle less is not", "[gnc][R27]") {
    TouchdownLogic logic;
    for (std::uint32_t i = 1; i < touchdown_cycles; ++i)
        CHECK_FALSE(all_hold(logic.on(parameters, stage_N, mass_kg, rover_kg)));
    CHECK(all_hold(logic.on(parameters, stage_N, mass_kg, rover_kg)));
}

TEST_CASE("a bounce off the weight starts the wait anew", "[gnc][R27]") {
    TouchdownLogic logic;
    for (std::uint32_t i = 1; i < touchdown_cycles; ++i) logic.on(parameters, stage_N, mass_kg, rover_kg);
    CHECK_FALSE(all_hold(logic.on(parameters, 1.2 * stage_N, mass_kg, rover_kg)));
    CHECK_FALSE(all_hold(logic.on(parameters, stage_N, mass_kg, rover_kg)));
}

}  // namespace flight_gnc_touchdown_logic_test
