// SPDX-License-Identifier: Apache-2.0
#include "common/calendar.hpp"
#include "tests/support/catch.hpp"

namespace common_calendar_test {

using namespace aeolis;

TEST_CASE("days are counted as the Gregorian calendar has them", "[common]") {
    CHECK(days_since_2000(2000, 1, 1) == 0);
    CHECK(days_since_2000(2000, 3, 1) == 60);
    CHECK(days_since_2000(2012, 8, 6) == 4601);
    CHECK(days_since_2000(1970, 1, 1) == -10957);
    CHECK(days_since_2000(1858, 11, 17) == 51544 * -1);  // the modified Julian date's beginning
    std::int64_t next = *days_since_2000(1899, 1, 1);
    for (int year = 1899; year < 2110; ++year)
        for (unsigned month = 1; month <= 12; ++month)
            for (unsigned day = 1; days_since_2000(year, month, day); ++day)
                REQUIRE(days_since_2000(year, month, day) == next++);
    CHECK(next == days_since_2000(2110, 1, 1));
}

TEST_CASE("what is no date has no number", "[common]") {
    CHECK_FALSE(days_since_2000(2001, 2, 29));
    CHECK_FALSE(days_since_2000(1900, 2, 29));
    CHECK(days_since_2000(2000, 2, 29));
    CHECK_FALSE(days_since_2000(2000, 13, 1));
    CHECK_FALSE(days_since_2000(2000, 0, 1));
    CHECK_FALSE(days_since_2000(2000, 1, 0));
    CHECK_FALSE(days_since_2000(0, 1, 1));
    CHECK_FALSE(days_since_2000(10000, 1, 1));
}

}  // namespace common_calendar_test
