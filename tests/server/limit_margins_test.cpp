// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/limit_margins.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace server_limit_margins_test {

using namespace aeolis::server::campaign;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Four cases: two within their limits, one too fast, one lost.
CaseTable four() {
    CaseTable table;
    table.numbers = {1, 2, 5, 9};
    table.outcomes = {"touchdown", "touchdown", "touchdown", "lost"};
    table.columns = {{"vertical_mps", {0.70, 0.80, 0.95, none}},
                     {"propellant_kg", {40.0, 12.0, 30.0, 0.0}},
                     {"heatshield_least_m", {none, 65.0, 20.0, 1.0}},
                     {"backshell_least_m", {90.0, 60.0, 15.0, 0.0}},
                     {"limits_exceeded", {0.0, 0.0, 1.0, 0.0}}};
    return table;
}

const LimitMargin& limit(const CampaignVerdict& verdict, const char* name) {
    const auto found = std::ranges::find(verdict.limits, name, &LimitMargin::limit);
    REQUIRE(found != verdict.limits.end());
    return *found;
}

}  // namespace

TEST_CASE("a campaign tells each limit's margin, by the landing that came nearest to it", "[campaign][limits]") {
    const CampaignVerdict verdict = verdict_of(four(), {});
    const LimitMargin& down = limit(verdict, "touchdown_vertical_max_mps");
    CHECK(down.value == 0.95);
    CHECK(down.margin == Approx(-0.10));
    CHECK(down.number == 5);
    CHECK(down.exceeded == 1);
    const LimitMargin& left = limit(verdict, "propellant_left_min_kg");  // what was lost is no landing
    CHECK(left.value == 12.0);
    CHECK(left.margin == Approx(8.0));
    CHECK(left.exceeded == 0);
    const LimitMargin& apart = limit(verdict, "recontact_min_m");  // of both bodies
    CHECK(apart.value == 15.0);
    CHECK(apart.number == 5);
    CHECK(apart.exceeded == 1);                                      // one landing, though both bodies came too near
    const LimitMargin& mach = limit(verdict, "parachute_mach_max");  // no landing has a figure of it
    CHECK(mach.number == 0);
    CHECK(std::isnan(mach.value));
    CHECK_THAT(verdict_table(verdict), Catch::Contains("parachute_mach_max                       2.2 no figure\n"));
    CHECK_THAT(verdict_json(verdict), Catch::Contains("\"limit\":\"parachute_mach_max\",\"bound\":2.2,\"worst\":null"));
    CHECK_THAT(verdict_table(verdict), Catch::Contains("FAILED: 2 of 4 cases landed within all limits, 50.00 %"));
    CHECK_THAT(verdict_json(verdict), Catch::Contains("\"verdict\":\"failed\"") &&
                                          Catch::Contains("\"limit\":\"recontact_min_m\",\"bound\":25,\"worst\":15"));
}

TEST_CASE("a campaign passes from the fraction of its cases that the scenario requires, on both sides of it",
          "[campaign][limits]") {
    aeolis::simulation::Limits limits;
    limits.campaign_within_min_fraction = 0.5;
    CHECK(verdict_of(four(), limits).passes());
    limits.campaign_within_min_fraction = 0.51;
    CHECK_FALSE(verdict_of(four(), limits).passes());
    limits.campaign_within_min_fraction = 0.0;
    CHECK_FALSE(verdict_of({}, limits).passes());  // nothing was flown
}

}  // namespace server_limit_margins_test
