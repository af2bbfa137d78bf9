// SPDX-License-Identifier: Apache-2.0
#include "telemetry/link_rhythm.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>

namespace telemetry_link_rhythm_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

Ert at_s(double seconds) {
    return Ert{std::llround(seconds * 1e6)};
}

}  // namespace

TEST_CASE("a followed link is silent when packets stay out three times as long as they did lately",
          "[telemetry][downlink][R54]") {
    for (const double every_s : {0.05, 1.0, 10.0, 60.0}) {
        LinkRhythm rhythm;
        double now_s = 0.0;
        for (unsigned i = 0; i <= LinkRhythm::intervals_known; ++i) {
            CHECK_FALSE(rhythm.silent(at_s(now_s + 1000.0 * every_s)));  // not before its rhythm is known
            rhythm.heard(at_s(now_s));
            now_s += every_s;
        }
        const double last_s = now_s - every_s, limit_s = std::max(3.0, 3.0 * every_s);
        CHECK_FALSE(rhythm.silent(at_s(last_s + limit_s - 0.01)));
        const auto silence = rhythm.silent(at_s(last_s + limit_s + 0.01));
        REQUIRE(silence);
        CHECK(silence->since.microseconds == at_s(last_s).microseconds);
        CHECK(silence->interval_s == Approx(every_s));
        // What was a silence is not learnt as a rhythm.
        rhythm.heard(at_s(last_s + 100.0 * limit_s));
        CHECK(rhythm.silent(at_s(last_s + 102.0 * limit_s)));
    }
}

TEST_CASE("a link that becomes slower is told a few times, and then expected so", "[telemetry][downlink]") {
    LinkRhythm rhythm;
    double now_s = 0.0;
    for (int i = 0; i < 20; ++i) rhythm.heard(at_s(now_s += 1.0));
    unsigned told = 0;
    for (int i = 0; i < 20; ++i) {
        told += rhythm.silent(at_s(now_s + 29.9)) ? 1 : 0;
        rhythm.heard(at_s(now_s += 30.0));
    }
    CHECK(told == LinkRhythm::silences_until_slower);
}

TEST_CASE("a link that becomes faster is soon expected faster", "[telemetry][downlink]") {
    LinkRhythm rhythm;
    double now_s = 0.0;
    for (int i = 0; i < 20; ++i) rhythm.heard(at_s(now_s += 60.0));
    for (int i = 0; i < 300; ++i) rhythm.heard(at_s(now_s += 0.1));
    CHECK(rhythm.silent(at_s(now_s + 3.1)));
}

}  // namespace telemetry_link_rhythm_test
