// SPDX-License-Identifier: Apache-2.0
#include "telemetry/link_counters.hpp"
#include "tests/support/catch.hpp"

namespace telemetry_link_counters_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("a rate is the mean of the last ten whole seconds, and falls to zero when nothing comes", "[telemetry]") {
    RateMeter meter;
    const auto at = [](double seconds) { return Ert{static_cast<std::int64_t>(seconds * 1e6)}; };
    CHECK(meter.per_second(at(1000.0)) == 0.0);
    for (int i = 0; i < 300; ++i) meter.add(at(1000.0 + i / 10.0), 5);
    CHECK(meter.per_second(at(1030.0)) == Approx(50.0));
    CHECK(meter.per_second(at(1035.0)) == Approx(25.0));
    CHECK(meter.per_second(at(1040.0)) == 0.0);
    meter.add(at(2000.5), 10);
    CHECK(meter.per_second(at(2000.9)) == 0.0);
    CHECK(meter.per_second(at(2001.0)) == 1.0);
    meter.add(at(1990.0), 10);
    CHECK(meter.per_second(at(2001.0)) == 2.0);
}

}  // namespace telemetry_link_counters_test
