// SPDX-License-Identifier: Apache-2.0
#include "common/entry_time.hpp"

#include "tests/support/catch.hpp"

namespace common_entry_time_test {

using namespace aeolis;

TEST_CASE("a time from entry has minutes and seconds, hours only from the first on, and is truncated like a clock",
          "[time]") {
    CHECK(from_entry_text(0.0) == "E+0:00");
    CHECK(from_entry_text(298.9) == "E+4:58");
    CHECK(from_entry_text(431.47) == "E+7:11");
    CHECK(from_entry_text(100.0 - 1e-6) == "E+1:40");  // a rounded clock
    CHECK(from_entry_text(3599.9) == "E+59:59");
    CHECK(from_entry_text(3723.0) == "E+1:02:03");
    CHECK(from_entry_text(7200.0) == "E+2:00:00");
    CHECK(from_entry_text(-726.0) == "E−12:06");
    CHECK(from_entry_text(-0.5) == "E−0:01");
    CHECK(from_entry_text(-21600.0) == "E−6:00:00");
}

TEST_CASE("a time from entry with tenths is rounded to them", "[time]") {
    CHECK(from_entry_tenths_text(0.0) == "E+0:00.0");
    CHECK(from_entry_tenths_text(430.04) == "E+7:10.0");
    CHECK(from_entry_tenths_text(59.96) == "E+1:00.0");
    CHECK(from_entry_tenths_text(-0.3) == "E−0:00.3");
    CHECK(from_entry_tenths_text(3723.25) == "E+1:02:03.3");
}

}  // namespace common_entry_time_test
