// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_time.hpp"
#include "tests/support/kernels.hpp"

namespace telemetry_packet_time_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("a packet's time is UTC as far as kernels are given, else a number", "[telemetry][kernel]") {
    const TimeKernels none;
    TimeKernels leaps;
    leaps.leaps = tests::leap_seconds();
    TimeKernels both = leaps;
    both.clock = *tests::clock_of(tests::landing_clock);

    CHECK(time_text({1344230277.123, "UNIX"}, none) == "2012-219T05:17:57.123");
    CHECK(time_text({397501174.5, ""}, none) == "397501174.5");
    CHECK(time_text({397501174.5, ""}, leaps) == "397501174.5");
    CHECK(time_text({397501174.5, ""}, both) == "2012-219T05:10:47.900");
    CHECK(time_text({-1.0, ""}, both) == "undefined");  // the clock was never there
    // GPS time was 0 on 1980-01-06, and 16 s ahead of UTC in August 2012; TAI 35 s.
    CHECK(time_text({0.0, "GPS"}, leaps) == "1980-006T00:00:00.000");
    CHECK(time_text({1028265493.0, "GPS"}, leaps) == "2012-219T05:17:57.000");
    CHECK(time_text({1028265493.0, "GPS"}, none) == "1028265493");
    CHECK(time_text({1722921512.0, "TAI"}, leaps) == "2012-219T05:17:57.000");
    CHECK(time_text({12.0, "J2000"}, both) == "12");  // of which scale the file does not say
}

}  // namespace telemetry_packet_time_test
