// SPDX-License-Identifier: Apache-2.0
#include "commands/release_pace.hpp"
#include "tests/support/catch.hpp"

namespace commands_release_pace_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

Ert at_s(double s) {
    return Ert{static_cast<std::int64_t>(s * 1.0e6)};
}

int leaving(ReleasePace& pace, double from_s, double to_s) {
    int left = 0;
    for (double s = from_s; s <= to_s; s += 1.0 / 64.0)
        for (; pace.has_room(at_s(s)); ++left) pace.count();
    return left;
}

}  // namespace

TEST_CASE("eight leave at once, then as many as half of the downlink carries the answers of", "[commands][R63]") {
    for (const double downlink_bps : {2'000.0, 8'000.0, 128'000.0}) {
        ReleasePace pace{downlink_bps};
        CHECK(leaving(pace, 1000.0, 1000.0) == 8);
        const double carried = 100.0 * downlink_bps / 8.0 * ReleasePace::downlink_share / ReleasePace::answer_octets;
        CHECK(leaving(pace, 1000.0, 1100.0) == Approx(carried).margin(1.0));
    }
}

TEST_CASE("a pause lets no more than eight leave at once, and a clock that goes back lets none", "[commands][R63]") {
    ReleasePace pace{8'000.0};
    CHECK(leaving(pace, 1000.0, 1000.0) == 8);
    CHECK(leaving(pace, 900.0, 900.0) == 0);
    CHECK(leaving(pace, 5000.0, 5000.0) == 8);
}

}  // namespace commands_release_pace_test
