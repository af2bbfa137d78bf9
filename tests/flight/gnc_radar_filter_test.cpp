// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/navigation/radar_filter.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_radar_filter_test {

using namespace aeolis;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

/// A descent at a steady rate whose navigation is wrong by a constant; radar averages of the truth over 5 s.
struct Descent {
    RadarFilter filter;
    double rate_mps = 80.0, truth_m = 9000.0;
    double error_m = 0.0, error_mps = 0.0;
    std::int64_t ticks = 0;
    RadarJudgement judged;

    Vector3 navigated_v() const { return -(rate_mps - error_mps) * Vector3::UnitX(); }
    void fly(double seconds) {
        for (int i = 0; i < seconds * 64; ++i) {
            ++ticks;
            truth_m -= rate_mps / 64;
            error_m += error_mps / 64;
            filter.remember(Sclk::from_ticks(ticks), truth_m + error_m, navigated_v());
        }
    }
    bool update(double wrong_m = 0.0) {
        const Sclk now = Sclk::from_ticks(ticks);
        const RadarSolution solution{now - 2.5, 5.0, truth_m + 2.5 * rate_mps + wrong_m, {-rate_mps, 0, 0}, 600};
        judged = filter.on(parameters, solution, now, Vector3::UnitX());
        if (!judged.accepted()) return false;
        error_m += judged.correction.altitude_m;
        error_mps += judged.correction.v_M_mps.x();
        return true;
    }
};

}  // namespace

TEST_CASE("the first solution takes out kilometres of error, delay or not", "[gnc][R25]") {
    Descent descent;
    descent.error_m = -1500.0;
    descent.error_mps = 8.0;
    descent.fly(6.0);
    CHECK_FALSE(descent.filter.locked());
    REQUIRE(descent.update());
    CHECK(descent.filter.locked());
    CHECK(std::abs(descent.error_m) < 0.5);
    CHECK(std::abs(descent.error_mps) < 1e-9);
}

TEST_CASE("corrections once a second of averages over five do not ring", "[gnc][R25]") {
    Descent descent;
    descent.fly(6.0);
    REQUIRE(descent.update());
    descent.error_m += 20.0;  // a step that the filter's past does not know of
    double largest_undershoot_m = 0.0;
    for (int i = 0; i < 30; ++i) {
        descent.fly(1.0);
        descent.update();
        largest_undershoot_m = std::min(largest_undershoot_m, descent.error_m);
    }
    CHECK(std::abs(descent.error_m) < 0.5);
    CHECK(largest_undershoot_m > -4.0);
}

TEST_CASE("a range that is short by a fraction leaves an error of the height flown in the last seconds, no more",
          "[gnc][R25]") {
    constexpr double fraction = -0.017, rate_mps = 20.0;
    Descent descent;
    descent.rate_mps = rate_mps;
    descent.truth_m = 1000.0;
    descent.fly(6.0);
    for (int i = 0; i < 30; ++i) {
        descent.update(fraction * (descent.truth_m + 2.5 * rate_mps));
        descent.fly(1.0);
    }
    // The average lags 2.5 s; the gain and a solution a second may add 2 s.
    const double excess_m = std::abs(descent.error_m) - std::abs(fraction) * descent.truth_m;
    CHECK(descent.error_m < 0.0);
    CHECK(excess_m < std::abs(fraction) * rate_mps * 4.5);
    CHECK(excess_m > std::abs(fraction) * rate_mps * 2.0);
}

TEST_CASE("a wild solution is refused, five in a row are believed", "[gnc][R25][R38]") {
    Descent descent;
    descent.fly(6.0);
    REQUIRE(descent.update());
    CHECK(descent.judged.verdict == RadarJudgement::Verdict::taken);
    for (int i = 0; i < 5; ++i) {
        descent.fly(1.0);
        CHECK_FALSE(descent.update(2000.0));
        REQUIRE(descent.judged.verdict == RadarJudgement::Verdict::refused);
        const Conditions& why = descent.judged.conditions;
        REQUIRE(why.size() == 3);
        CHECK(why[0].quantity == Quantity::radar_altitude_residual_m);
        CHECK(why[0].value == Approx(2000.0).margin(1.0));
        CHECK(why[0].bound ==
              Approx(parameters.radar_altitude_gate_m +
                     parameters.radar_altitude_gate_fraction * (descent.truth_m + 2.5 * descent.rate_mps + 2000.0)));
        CHECK_FALSE(why[0].holds);
        CHECK(why[1].holds);
        CHECK(why[2].value == i);
        CHECK_FALSE(why[2].holds);
    }
    CHECK(descent.filter.refused() == 5);
    descent.fly(1.0);
    CHECK(descent.update(2000.0));
    CHECK(descent.judged.verdict == RadarJudgement::Verdict::believed);
    CHECK_FALSE(descent.judged.conditions[0].holds);
    CHECK(descent.judged.conditions[2].holds);
}

TEST_CASE("without a past that covers it a solution is not used", "[gnc][R25]") {
    Descent descent;
    descent.fly(1.0);
    CHECK_FALSE(descent.update());
}

}  // namespace flight_gnc_radar_filter_test
