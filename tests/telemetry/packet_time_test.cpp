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
}

TEST_CASE("J2000 is of TT, a date of UTC, and the seconds since them are elapsed ones", "[telemetry][kernel]") {
    const TimeKernels none;
    TimeKernels leaps;
    leaps.leaps = tests::leap_seconds();
    CHECK(time_text({0.0, "J2000"}, leaps) == "2000-001T11:58:55.816");
    CHECK(time_text({397501174.5, "J2000"}, leaps) == "2012-219T04:58:27.316");  // TT less 67.184 s
    CHECK(time_text({12.0, "J2000"}, none) == "12 s after J2000");
    // Five leap seconds were inserted from 2000 to the end of 2016, the first at the end of 2005.
    CHECK(time_text({0.0, "2000-01-01"}, leaps) == "2000-001T00:00:00.000");
    CHECK(time_text({0.0, "2000-01-01T12:00:00"}, leaps) == "2000-001T12:00:00.000");
    CHECK(time_text({86400.0 * 366, "2000-01-01T12:00:00Z"}, leaps) == "2001-001T12:00:00.000");
    CHECK(time_text({86400.0 * 6575 + 5.0, "2000-01-01T00:00:00"}, leaps) == "2018-001T00:00:00.000");
    CHECK(time_text({0.0, "2010-01-01T01:00:00.5+01:00"}, leaps) == "2010-001T00:00:00.500");
    CHECK(time_text({0.0, "2009-12-31T19:00:00-05:00"}, leaps) == "2010-001T00:00:00.000");
    CHECK(time_text({0.0, "1980-01-06"}, leaps) == time_text({0.0, "GPS"}, leaps));
    CHECK(time_text({1722921512.0, "1958-01-01T00:00:00"}, leaps) == time_text({1722921512.0, "TAI"}, leaps));
    for (const auto* kernels : std::initializer_list<const TimeKernels*>{&none, &leaps})
        CHECK(time_text({1344230277.123, "1970-01-01T00:00:00"}, *kernels) == "2012-219T05:17:57.123");
    CHECK(time_text({12.0, "2000-01-01"}, none) == "12 s after 2000-01-01");
    CHECK(time_text({12.0, "1965-01-01"}, leaps) == "12 s after 1965-01-01");  // UTC had seconds of its own
    for (const char* epoch : {"2000-13-01", "2000-01-01T12:00:00+1:00", "SOMETIME", "2000-01-01T12:00:00+0x:00"})
        CHECK(time_text({12.0, epoch}, leaps) == std::string{"12 s after "} + epoch);
}

}  // namespace telemetry_packet_time_test
