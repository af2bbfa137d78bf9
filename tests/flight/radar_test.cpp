// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/radar.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_radar_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("radar returns go on to EdlBg and to the recording in the cycle in which they came, once",
          "[devices][R10][R52]") {
    test::Spoken<RadarManager> radar{ModuleId::radar};
    RadarReturns returns{Sclk{1.0}, {}};
    returns.beams.push_back({.beam = 3, .valid = true});
    CHECK(radar.on(returns).out.sent().empty());
    const auto sent = radar.on(Tick{Sclk{1.0}}).sent<RadarReturns>();
    REQUIRE(sent.size() == 2);
    CHECK(sent[0].beams[0].beam == 3);
    CHECK(sent[1].beams[0].beam == 3);
    CHECK(radar.on(Tick{Sclk{1.0}}).sent<RadarReturns>().empty());
}

TEST_CASE("the radar's manager confirms each tick and addresses the selected unit", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<RadarManager>(ModuleId::radar, Device::radar));
}

}  // namespace flight_radar_test
