// SPDX-License-Identifier: Apache-2.0
#include "telemetry/leap_seconds.hpp"
#include "tests/support/kernels.hpp"

#include <random>

namespace telemetry_leap_seconds_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

std::string fault(const std::string& from, const std::string& to) {
    std::string text = tests::leap_second_kernel;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    const auto kernel = TextKernel::parse(text, "k.tls");
    REQUIRE(kernel);
    const auto leaps = LeapSeconds::read(*kernel);
    return leaps ? "" : leaps.error().message;
}

}  // namespace

TEST_CASE("ephemeris time is UTC as NAIF's lessons and the definition of J2000 have it", "[telemetry][kernel]") {
    const auto leaps = tests::leap_seconds();
    // NAIF's lesson "Time conversion": 2004 JUN 11 19:32:00 is 140254384.184625 s.
    CHECK(leaps.utc_of_tdb(140254384.184625)->text() == "2004-163T19:32:00.000");
    CHECK(*leaps.tdb_of_utc(*leaps.utc_of_tdb(140254384.184625)) == Approx(140254384.184625).margin(1e-6).epsilon(0));
    // J2000, 12:00:00 TT, is 11:58:55.816 UTC.
    CHECK(leaps.utc_of_tt(0.0)->text() == "2000-001T11:58:55.816");
    // On 6 August 2012 ET was 67.184 s ahead.
    CHECK(leaps.utc_of_tt(397501914.584)->text() == "2012-219T05:10:47.400");
}

TEST_CASE("the second that was put in is called 60, and lasts one second", "[telemetry][kernel]") {
    const auto leaps = tests::leap_seconds();
    const double tai_s = 536500836.0;  // 2017-01-01T00:00:36 TAI, when 37 s began to count
    CHECK(leaps.utc_of_tai(tai_s - 0.5)->text() == "2016-366T23:59:59.500");
    CHECK(leaps.utc_of_tai(tai_s)->text() == "2016-366T23:59:60.000");
    CHECK(leaps.utc_of_tai(tai_s + 0.75)->text() == "2016-366T23:59:60.750");
    CHECK(leaps.utc_of_tai(tai_s + 0.9999999)->text() == "2017-001T00:00:00.000");
    CHECK(leaps.utc_of_tai(tai_s + 1.0)->text() == "2017-001T00:00:00.000");
    const auto utc = *leaps.utc_of_tai(tai_s + 0.75);
    CHECK(utc.leap_second);
    CHECK(*leaps.utc_of_tdb(*leaps.tdb_of_utc(utc)) == utc);
}

TEST_CASE("UTC to ephemeris time and back is the same microsecond, from 1972 to 2100", "[telemetry][kernel]") {
    const auto leaps = tests::leap_seconds();
    std::mt19937_64 random{3};
    std::uniform_int_distribution<std::int64_t> any{-883'656'000'000'000, 3'155'760'000'000'000};
    for (int i = 0; i < 2000; ++i) {
        const UtcInstant utc{any(random), false};
        REQUIRE(*leaps.utc_of_tdb(*leaps.tdb_of_utc(utc)) == utc);
    }
    CHECK_FALSE(leaps.tdb_of_utc({-883'656'000'000'001, false}));
    CHECK_FALSE(leaps.utc_of_tdb(-1.0e9));
    CHECK_FALSE(leaps.utc_of_tdb(1.0e300));
}

TEST_CASE("a table of leap seconds that cannot be is refused with file and line", "[telemetry][kernel]") {
    CHECK(fault("DELTET/K ", "DELTET/X ") == "k.tls: it says no DELTET/K");
    CHECK(fault("37, @2017-JAN-1", "37") == "k.tls:7: DELTET/DELTA_AT is not a list of pairs: seconds, date");
    CHECK(fault("11, @1972-JUL-1", "11, @1971-JUL-1") == "k.tls:7: DELTET/DELTA_AT is not in the order of its dates");
    CHECK(fault("12, @1973-JAN-1", "1e9, @1973-JAN-1") == "k.tls:7: DELTET/DELTA_AT holds no possible number");
    CHECK(fault("( 6.239996D0 1.99096871D-7 )", "6.2") == "k.tls:6: DELTET/M has 1 values where 2 are wanted");
}

}  // namespace telemetry_leap_seconds_test
