// SPDX-License-Identifier: Apache-2.0
#include "common/ephemeris_time.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <random>

namespace common_ephemeris_time_test {

using namespace aeolis;

TEST_CASE("a microsecond of UTC goes to ephemeris time and back, also about a leap second", "[ephemeris]") {
    // The instant of entry of 2012 by both clocks: 35 leap seconds, 32.184 s, and TDB about a millisecond off TT.
    const auto entry = scet_from_text("2012-08-06T05:10:47.4");
    REQUIRE(entry);
    CHECK(leap_seconds_at(*entry) == 35);
    CHECK(std::abs(ephemeris_time_of(*entry).seconds - (397501847.4 + 35.0 + 32.184)) < 0.002);
    CHECK_FALSE(leap_seconds_at(*scet_from_text("1971-12-31T23:59:59")));
    CHECK(leap_seconds_at(*scet_from_text("1972-01-01T00:00:00")) == 10);
    CHECK(leap_seconds_at(*scet_from_text("2016-12-31T23:59:59")) == 36);
    CHECK(leap_seconds_at(*scet_from_text("2017-01-01T00:00:00")) == 37);
    std::mt19937 random{11};
    const std::int64_t leap_us = scet_from_text("2012-07-01T00:00:00")->microseconds;
    for (int i = 0; i < 2'000; ++i) {
        const Scet near{leap_us + static_cast<std::int64_t>(random() % 80'000'000) - 40'000'000};
        const Scet far{static_cast<std::int64_t>(random()) * 200'000 - 300'000'000'000'000};
        for (const Scet utc : {near, far}) {
            CAPTURE(utc.microseconds);
            CHECK(std::abs(utc_of(ephemeris_time_of(utc)).microseconds - utc.microseconds) <= 1);
        }
    }
}

TEST_CASE("an instant is written and read in each time system", "[ephemeris]") {
    const EphemerisTime time = ephemeris_time_of(*scet_from_text("2012-08-06T05:10:47.4"));
    CHECK(calendar_text(time, TimeSystem::utc) == "2012-08-06T05:10:47.400000");
    CHECK(calendar_text(time, TimeSystem::tai) == "2012-08-06T05:11:22.400000");
    CHECK(calendar_text(time, TimeSystem::tt) == "2012-08-06T05:11:54.584000");
    CHECK(calendar_text(time, TimeSystem::gps) == "2012-08-06T05:11:03.400000");
    for (const auto system : {TimeSystem::utc, TimeSystem::tai, TimeSystem::tt, TimeSystem::tdb, TimeSystem::gps}) {
        CHECK(time_system_named(name_of(system)) == system);
        const auto read = ephemeris_time_from_text(calendar_text(time, system), system);
        REQUIRE(read);
        CHECK(std::abs(*read - time) < 2e-6);
    }
    CHECK(calendar_text({0.0}, TimeSystem::tdb) == "2000-01-01T12:00:00.000000");
    CHECK(calendar_text({-86400.0 * 1.5 - 1e-6}, TimeSystem::tdb) == "1999-12-30T23:59:59.999999");
    CHECK_FALSE(ephemeris_time_from_text("yesterday", TimeSystem::utc));
    CHECK_FALSE(time_system_named("UT1"));
}

}  // namespace common_ephemeris_time_test
