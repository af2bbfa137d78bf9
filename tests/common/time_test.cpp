// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"
#include "tests/support/catch.hpp"

namespace common_time_test {

using namespace aeolis;

TEST_CASE("a clock of n hertz is the time cut to 1/n s, exactly", "[common][R21]") {
    const Sclk t = Sclk::from_ticks(64LL * 397501174 + 63);
    CHECK(at_resolution(t, 64) == t);
    CHECK(at_resolution(t, 2).seconds == 397501174.5);
    CHECK(at_resolution(t, 1).seconds == 397501174.0);
    CHECK(at_resolution(Sclk{-0.25}, 1).seconds == -1.0);
}

TEST_CASE("sums of 1/64 s have no round-off over a mission's length", "[common][R21]") {
    Sclk t{4.0e9};
    for (int i = 0; i < 64 * 1000; ++i) t = t + seconds_per_tick;
    CHECK(t.seconds == 4.0e9 + 1000.0);
    CHECK(t.ticks() == 64LL * (4'000'000'000LL + 1000));
}

TEST_CASE("only multiples of 1/64 s are offsets", "[common][R21]") {
    CHECK(is_multiple_of_tick(-826.015625));
    CHECK_FALSE(is_multiple_of_tick(0.3));
    CHECK_FALSE(is_multiple_of_tick(1.0e300));
}

TEST_CASE("undefined spreads through arithmetic and is false in a condition", "[common][R13]") {
    const Sclk now{10.0};
    CHECK(now >= MaybeTime{Sclk{9.0}} + MaybeOffset{1.0});
    CHECK_FALSE(now >= MaybeTime{Sclk{9.0}} + MaybeOffset{1.015625});
    CHECK_FALSE(now >= MaybeTime{Sclk{9.0}} + MaybeOffset{});
    CHECK_FALSE(now >= MaybeTime{} + MaybeOffset{-100.0});
    CHECK(now >= MaybeTime{Sclk{12.0}} + MaybeOffset{-2.0});
}

TEST_CASE("UTC is shown by day of year", "[common]") {
    // 2012-08-06T05:10:47.400 is day 219; 397 501 847.4 s after 2000-01-01T12:00:00, leap seconds not counted.
    CHECK(day_of_year_text(Scet{397'501'847'400'000}) == "2012-219T05:10:47.400");
    CHECK(day_of_year_text(Ert{0}) == "2000-001T12:00:00.000");
}

TEST_CASE("SCET follows SCLK through the correlated instant", "[common]") {
    const ClockCorrelation clocks{Sclk{100.0}, Scet{5'000'000}};
    CHECK(clocks.scet_of(Sclk{101.5}).microseconds == 6'500'000);
}

TEST_CASE("a clock that drifts is led to SCET by its rate, and back", "[common]") {
    ClockCorrelation clocks{Sclk{100.0}, Scet{5'000'000}};
    clocks.rate = 1.0 + 1.0e-5;
    CHECK(clocks.scet_of(Sclk{100'100.0}).microseconds == 5'000'000 + 100'000'000'000 + 1'000'000);
    CHECK(clocks.sclk_of(clocks.scet_of(Sclk{100'100.0})).seconds == Approx(100'100.0).margin(2e-6));
    CHECK(clocks.sclk_of(Scet{5'000'000}) == Sclk{100.0});
}

TEST_CASE("a clock without drift keeps SCET to the microsecond as by the instant alone", "[common][invariant1]") {
    const ClockCorrelation clocks{Sclk{397501715.0}, Scet{397'501'847'400'000}};
    for (std::int64_t tick = -1000; tick < 1000; ++tick) {
        const Sclk t = clocks.sclk + static_cast<double>(tick) * seconds_per_tick;
        CHECK(clocks.scet_of(t).microseconds ==
              clocks.scet.microseconds + static_cast<std::int64_t>((t - clocks.sclk) * 1.0e6));
    }
}

TEST_CASE("UTC is read by day of year and by calendar, to the microsecond, and nothing else is taken for it",
          "[common]") {
    for (const std::int64_t microseconds :
         {std::int64_t{0}, std::int64_t{397'501'847'400'000}, std::int64_t{-1'000'000'000'000}})
        CHECK(ert_from_text(day_of_year_text(Ert{microseconds})) == Ert{microseconds});
    CHECK(ert_from_text("2012-219T05:10:47") == Ert{397'501'847'000'000});
    CHECK(ert_from_text("2012-219T05:10:47.4") == Ert{397'501'847'400'000});
    CHECK(ert_from_text("2012-219T05:10:47.400001") == Ert{397'501'847'400'001});
    CHECK(ert_from_text("2012-219T05:10:47.4Z") == Ert{397'501'847'400'000});
    CHECK(scet_from_text("2012-08-06T05:10:47.4Z") == Scet{397'501'847'400'000});
    CHECK(scet_from_text("2000-01-01T12:00:00") == Scet{0});
    CHECK(scet_from_text("2012-02-29T00:00:00.000001") == scet_from_text("2012-060T00:00:00.000001"));
    CHECK(ert_from_text("2012-366T00:00:00").has_value());
    for (const char* text : {"",
                             "2012",
                             "tomorrow",
                             "2013-366T00:00:00",
                             "2012-000T00:00:00",
                             "2012-367T00:00:00",
                             "2012-219T24:00:00",
                             "2012-219T05:60:00",
                             "2012-219T05:10:60",
                             "2012-219T05:10:47.",
                             "2012-219T05:10:47.1234567",
                             "2012-219 05:10:47",
                             "2012-219T05:10:4x",
                             "-012-219T05:10:47",
                             "2013-02-29T00:00:00",
                             "2012-13-01T00:00:00",
                             "2012-08-06 05:10:47",
                             "2012-08-06T05:10:47z",
                             "2012-08-06T05:10:47+00:00Z",
                             "2012-08-06T05:10:47Z+00:00",
                             "2012-08-06T05:10:47+0000",
                             "2012-08-06T05:10:47+2:00",
                             "2012-08-06T05:10:47+24:00",
                             "2012-08-06T05:10:47+01:60",
                             "2012-08-06T05:10:47 02:00",
                             "2012-08-06T05:10:47+02:00:00",
                             "2012-06-30T23:59:60+00:00",
                             "2012-08-06T05:10+00:00",
                             "2012-08-06T05:10:47ZZ",
                             "-012-08-06T05:10:47",
                             "2012-8-6T05:10:47"}) {
        INFO(text);
        CHECK_FALSE(ert_from_text(text).has_value());
    }
}

TEST_CASE("a time with an offset from UTC is read as that instant, by calendar and by day of year", "[common][R62]") {
    const auto utc = scet_from_text("2012-08-06T05:10:47.4Z");
    REQUIRE(utc.has_value());
    for (const char* text :
         {"2012-08-06T05:10:47.4+00:00", "2012-08-06T05:10:47.400000-00:00", "2012-08-06T07:10:47.4+02:00",
          "2012-219T10:40:47.4+05:30", "2012-08-05T22:10:47.4-07:00", "2012-08-07T05:09:47.4+23:59"}) {
        INFO(text);
        CHECK(scet_from_text(text) == utc);
    }
    // What Python's datetime.isoformat() writes when there is no fraction; and over the end of a year.
    CHECK(ert_from_text("2012-01-01T00:30:00+01:00") == ert_from_text("2011-365T23:30:00"));
    // The leap second of 2012-06-30 is not counted: the instants on both sides of it are one second apart.
    CHECK(scet_from_text("2012-07-01T02:00:00+02:00")->microseconds -
              scet_from_text("2012-06-30T23:59:59+00:00")->microseconds ==
          1'000'000);
}

TEST_CASE("a time from entry is read with hours, minutes and seconds or seconds alone, before and after", "[common]") {
    CHECK(seconds_from_entry("E+4:58") == 298.0);
    CHECK(seconds_from_entry("E-1:02:03.5") == -3723.5);
    CHECK(seconds_from_entry("E\u22120:01") == -1.0);
    CHECK(seconds_from_entry("E+298.25") == 298.25);
    CHECK(seconds_from_entry("E-518400") == -518400.0);
    for (const char* text : {"", "E", "E4:58", "E+", "E+4:5", "E+4:60", "E+1:60:00", "E+:30", "E+1:00:00:00", "E+4:58.",
                             "e+4:58", "E+4:58 ", "E+12345678", "E+-5"}) {
        INFO(text);
        CHECK_FALSE(seconds_from_entry(text).has_value());
    }
}

}  // namespace common_time_test
