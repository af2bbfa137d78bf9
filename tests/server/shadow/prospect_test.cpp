// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/prospect.hpp"

#include "tests/support/catch.hpp"

#include <numeric>

namespace server_shadow_prospect_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::shadow;

namespace {

campaign::CaseResult landed(std::uint64_t number, double miss_m, double propellant_kg, std::uint64_t exceeded = 0) {
    campaign::CaseResult result;
    result.number = number;
    result.outcome = "touchdown";
    result.limits_exceeded = exceeded;
    result.touchdown = simulation::TouchdownReport{0.7, 0.1, miss_m, -4.6, 137.4, 1.0};
    result.east_m = miss_m;
    result.north_m = 0.5 * miss_m * (number % 2 == 0 ? 1.0 : -1.0);
    result.propellant_kg = propellant_kg;
    result.events = {{"entry_interface", 0.0}, {"touchdown", 430.0 + static_cast<double>(number)}};
    return result;
}

campaign::CaseResult crashed(std::uint64_t number) {
    campaign::CaseResult result;
    result.number = number;
    result.outcome = "impact";
    return result;
}

std::vector<double> up_to(int n) {
    std::vector<double> values(static_cast<std::size_t>(n));
    std::iota(values.begin(), values.end(), 1.0);
    return values;
}

}  // namespace

TEST_CASE("cases that all agree are no certainty: the interval is Clopper's and Pearson's", "[shadow]") {
    // Closed forms: all of n: the lower bound is 0.005^(1/n); none of n: the upper one is 1 − that.
    for (const std::uint64_t n : {1ULL, 32ULL, 1000ULL}) {
        const double edge = std::pow(0.005, 1.0 / static_cast<double>(n));
        CHECK(proportion(n, n).low == Approx(edge).epsilon(1e-9));
        CHECK(proportion(n, n).high == 1.0);
        CHECK(proportion(0, n).low == 0.0);
        CHECK(proportion(0, n).high == Approx(1.0 - edge).epsilon(1e-9));
    }
    // Published table of the F distribution: 5 of 10 at 99 %: 0.1283 … 0.8717.
    CHECK(proportion(5, 10).low == Approx(0.1283).margin(1e-4));
    CHECK(proportion(5, 10).high == Approx(0.8717).margin(1e-4));
    CHECK(proportion(0, 0).low == 0.0);
    CHECK(proportion(0, 0).high == 1.0);
}

TEST_CASE("a 99 % interval needs 199 values; with fewer the range says how much it holds", "[shadow]") {
    const Values few = values_of(up_to(198));
    CHECK_FALSE(few.interval_99);
    CHECK(few.between == Approx(197.0 / 199.0));
    CHECK(few.median == 99.5);
    const Values enough = values_of(up_to(199));
    REQUIRE(enough.interval_99);
    CHECK(enough.interval_99->from == 1.0);
    CHECK(enough.interval_99->to == 199.0);
    CHECK(enough.median == 100.0);
    // Of 1000 the fifth from either end: 1 − 10/1001.
    const Values many = values_of(up_to(1000));
    REQUIRE(many.interval_99);
    CHECK(many.interval_99->from == 5.0);
    CHECK(many.interval_99->to == 996.0);
    CHECK(values_of({}).count == 0);
    CHECK(values_of({7.0}).between == 0.0);
}

TEST_CASE("within limits is what landed and exceeded none; figures are of the cases that have them", "[shadow]") {
    const std::vector<campaign::CaseResult> cases{landed(1, 1000.0, 40.0), landed(2, 2000.0, 2.0, 1), crashed(3),
                                                  landed(4, 3000.0, 50.0)};
    const Prospect prospect = prospect_of(cases, simulation::Limits{}, 0.0);
    CHECK(prospect.cases == 4);
    CHECK(prospect.within.part == 2);
    CHECK(prospect.within.of == 4);
    CHECK(prospect.outcomes.at("impact") == 1);
    CHECK(prospect.miss_m.count == 3);
    CHECK(prospect.propellant_kg.least == 2.0);
    CHECK(prospect.ellipse_99);
    REQUIRE(prospect.events.size() == 1);  // entry is past
    CHECK(prospect.events.front().name == "touchdown");
    CHECK(prospect.events.front().e_s.count == 3);
    CHECK(prospect.limits.front().limit == "propellant_left_min_kg");
    CHECK(prospect.limits.front().number == 2);
    CHECK(prospect.limits.front().exceeded == 1);
    CHECK_FALSE(prospect_of(std::span{cases}.first(2), simulation::Limits{}, 0.0).ellipse_99);
}

TEST_CASE("pairs are of one number: what the assumption alone changes", "[shadow]") {
    const std::vector<campaign::CaseResult> without{landed(1, 1000.0, 40.0), landed(2, 1500.0, 30.0), crashed(3),
                                                    crashed(4)};
    const std::vector<campaign::CaseResult> with{landed(1, 1300.0, 38.0), crashed(2), landed(3, 10.0, 9.0), crashed(4)};
    const Pairs pairs = pairs_of(without, with);
    CHECK(pairs.within_both == 1);
    CHECK(pairs.only_without == 1);
    CHECK(pairs.only_with == 1);
    CHECK(pairs.within_neither == 1);
    CHECK(pairs.miss_change_m.count == 1);
    CHECK(pairs.miss_change_m.median == 300.0);
    CHECK(pairs.propellant_change_kg.median == -2.0);
}

}  // namespace server_shadow_prospect_test
