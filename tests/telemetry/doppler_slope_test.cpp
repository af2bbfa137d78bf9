// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/doppler_slope.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <vector>

namespace telemetry_doppler_slope_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

const TimeTable& doppler() {
    static const TimeTable table = TimeTable::make({0.0, 50.0, 100.0}, {-450000.0, -449000.0, -451000.0}).value();
    return table;
}

std::vector<CarrierReport> carrier(double slope, double off_hz, double until_s = 100.0) {
    std::vector<CarrierReport> reports;
    for (double t = 0.0; t < until_s; t += 0.125)
        reports.push_back({t, t > 40.0 && t < 45.0 ? CarrierLock::searching : CarrierLock::locked,
                           350.0 + slope * doppler().at(t) + off_hz * std::sin(3.0 * t), 0.1, 0.0, 22.0});
    for (auto& report : reports)
        if (report.lock == CarrierLock::searching) report.frequency_hz = 0.0;
    return reports;
}

}  // namespace

TEST_CASE("whether a Doppler was removed, is still there or was turned over shows in how the carrier follows it",
          "[tones][R56]") {
    for (const double slope : {0.0, 1.0, -1.0, -2.0}) {
        const auto found = doppler_slope(carrier(slope, 30.0), doppler());
        REQUIRE(found);
        CHECK(*found == Approx(slope).margin(0.05));
    }
    CHECK_FALSE(doppler_slope(carrier(1.0, 0.0, 5.0), doppler()));  // hardly any change
    CHECK_FALSE(doppler_slope(carrier(1.0, 2000.0), doppler()));    // no line
    CHECK_FALSE(doppler_slope({}, doppler()));
}

}  // namespace telemetry_doppler_slope_test
