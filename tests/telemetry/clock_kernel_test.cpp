// SPDX-License-Identifier: Apache-2.0
#include "telemetry/clock_kernel.hpp"
#include "tests/support/kernels.hpp"

#include <random>

namespace telemetry_clock_kernel_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

/// Two partitions of a clock that was reset, and two rates; TDB.
const std::string reset_clock = R"(SCLK_DATA_TYPE_9 = ( 1 )
SCLK01_TIME_SYSTEM_9 = ( 1 )
SCLK01_N_FIELDS_9 = ( 2 )
SCLK01_MODULI_9 = ( 100000 100 )
SCLK01_OFFSETS_9 = ( 0 0 )
SCLK_PARTITION_START_9 = ( 0 500 )
SCLK_PARTITION_END_9 = ( 100000 9000000 )
SCLK01_COEFFICIENTS_9 = ( 0 1000 1
50000 1600 1.5
100000 2400 2 ))";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::string fault(const std::string& from, const std::string& to) {
    const auto clock = tests::clock_of(replaced(reset_clock, from, to));
    return clock ? "" : clock.error().message;
}

}  // namespace

TEST_CASE("counts become time along the pieces between measured points", "[telemetry][kernel]") {
    const auto clock = tests::clock_of(reset_clock);
    REQUIRE(clock);
    CHECK(clock->spacecraft() == "9");
    CHECK(clock->partitions() == 2);
    CHECK(*clock->parallel_time_of(0.0) == 1000.0);
    CHECK(*clock->parallel_time_of(499.99) == Approx(1499.99));
    CHECK(*clock->parallel_time_of(500.0) == 1600.0);  // a jump where the next point says so
    CHECK(*clock->parallel_time_of(502.0) == 1603.0);
}

TEST_CASE("a count belongs to the first partition that holds it, or to the one asked for", "[telemetry][kernel]") {
    const auto clock = tests::clock_of(reset_clock);
    REQUIRE(clock);
    CHECK(*clock->parallel_time_of(10.0) == 1010.0);
    CHECK(*clock->parallel_time_of(10.0, 2) == 2400.0 + 2.0 * 5.0);
    CHECK(*clock->parallel_time_of(2000.0) == 2400.0 + 2.0 * 1995.0);
    CHECK_FALSE(clock->parallel_time_of(2000.0, 1));
    CHECK_FALSE(clock->parallel_time_of(1.0, 2));
    CHECK_FALSE(clock->parallel_time_of(1.0, 3));
    CHECK_FALSE(clock->parallel_time_of(90001.0));
    CHECK_FALSE(clock->parallel_time_of(-1.0));
}

TEST_CASE("time to count and back is the same time, in both partitions", "[telemetry][kernel]") {
    const auto clock = tests::clock_of(reset_clock);
    REQUIRE(clock);
    std::mt19937 random{5};
    for (int i = 0; i < 1000; ++i) {
        const double time_s = 1600.0 + 0.001 * static_cast<double>(random() % 5'000'000);
        const auto count = clock->count_at(time_s);
        REQUIRE(count.has_value() == (time_s < 2350.0 || time_s >= 2400.0));  // between them lies no count
        if (!count) continue;
        REQUIRE(*clock->parallel_time_of(count->first, count->second) == Approx(time_s).margin(1e-9));
    }
    CHECK_FALSE(clock->count_at(999.0));
    CHECK_FALSE(clock->count_at(1.0e9));
}

TEST_CASE("a clock that runs as TT gives UTC with its leap seconds", "[telemetry][kernel]") {
    const auto clock = tests::clock_of(tests::landing_clock);
    REQUIRE(clock);
    const auto leaps = tests::leap_seconds();
    CHECK(clock->scet_of(397501174.0, leaps)->text() == "2012-219T05:10:47.400");
    CHECK(clock->scet_of(397501174.0 + 429.723, leaps)->text() == "2012-219T05:17:57.123");
    CHECK_FALSE(clock->scet_of(5.0e9, leaps));
}

TEST_CASE("offsets are taken off each field", "[telemetry][kernel]") {
    const auto clock = tests::clock_of(replaced(reset_clock, "OFFSETS_9 = ( 0 0 )", "OFFSETS_9 = ( 3 50 )"));
    REQUIRE(clock);
    CHECK(*clock->parallel_time_of(5.5) == 1002.0);
    CHECK(clock->count_at(1002.0)->first == 5.5);
}

TEST_CASE("a clock that cannot be is refused with file and line", "[telemetry][kernel]") {
    CHECK(fault("SCLK_DATA_TYPE_9 = ( 1 )", "SCLK_DATA_TYPE_9 = ( 2 )") ==
          "clock.tsc:3: SCLK_DATA_TYPE_9 is not 1: other types of clock are not supported");
    CHECK(fault("SCLK_DATA_TYPE_9", "OTHER") == "clock.tsc: it says no SCLK_DATA_TYPE_…: it is no SCLK kernel");
    CHECK(fault("TIME_SYSTEM_9 = ( 1 )", "TIME_SYSTEM_9 = ( 3 )") ==
          "clock.tsc:4: SCLK01_TIME_SYSTEM_9 is neither 1 (TDB) nor 2 (TDT)");
    CHECK(fault("( 100000 100 )", "( 100000 )") == "clock.tsc:6: SCLK01_MODULI_9 has 1 values where 2 are wanted");
    CHECK(fault("( 100000 100 )", "( 100000 0 )") == "clock.tsc:6: SCLK01_MODULI_9 holds no possible number");
    CHECK(fault("N_FIELDS_9 = ( 2 )", "N_FIELDS_9 = ( 1e9 )") ==
          "clock.tsc:5: SCLK01_N_FIELDS_9 is not a whole number from 1 to 10");
    CHECK(fault("( 100000 9000000 )", "( 100000 )") ==
          "clock.tsc:9: SCLK_PARTITION_END_9 has 1 values where 2 are wanted");
    CHECK(fault("( 100000 9000000 )", "( 100000 400 )") ==
          "clock.tsc:9: SCLK_PARTITION_END_9 ends partition 2 before it begins, or nowhere");
    CHECK(fault("1600 1.5", "1600") ==
          "clock.tsc:10: SCLK01_COEFFICIENTS_9 is not a list of threes: ticks, time, rate");
    CHECK(fault("50000 1600", "50000 900") == "clock.tsc:10: SCLK01_COEFFICIENTS_9 is not in order at its point 2");
    CHECK(fault("2400 2 )", "2400 0 )") ==
          "clock.tsc:10: SCLK01_COEFFICIENTS_9 has a rate that is not above 0 at its point 3");
    CHECK(fault("SCLK_DATA_TYPE_9 = ( 1 )", "SCLK_DATA_TYPE_8 = 1\nSCLK_DATA_TYPE_9 = 1") ==
          "clock.tsc:4: SCLK_DATA_TYPE_9 is the clock of a second spacecraft: give a kernel of one");
}

}  // namespace telemetry_clock_kernel_test
