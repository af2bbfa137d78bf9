// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/cruise_attitude.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

#include <limits>

namespace flight_cruise_attitude_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("an attitude of the star scanner goes on to Edl", "[devices][R10]") {
    test::Spoken<CruiseAttitudeControl> cruise{ModuleId::edl};
    const auto sent = cruise.on(CruiseAttitude{{0.6, 0.0, -0.8, 0.0}}).sent<CruiseAttitude>();
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].q_MB == std::array{0.6, 0.0, -0.8, 0.0});
    CHECK(cruise.recorder.out.sent()[0].to == ModuleId::edl);
}

TEST_CASE("what is no unit quaternion is not used, and reported", "[devices][R4]") {
    test::Spoken<CruiseAttitudeControl> cruise{ModuleId::edl};
    for (const double w :
         {0.0, 1.01, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        cruise.on(CruiseAttitude{{w, 0.0, 0.0, 0.0}});
        CHECK(cruise.recorder.sent<CruiseAttitude>().empty());
        CHECK(cruise.recorder.events<evr::CRUISE_ATTITUDE_UNUSABLE>() == 1);
    }
}

}  // namespace flight_cruise_attitude_test
