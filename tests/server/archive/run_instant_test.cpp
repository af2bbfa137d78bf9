// SPDX-License-Identifier: Apache-2.0
#include "server/archive/run_instant.hpp"
#include "tests/support/catch.hpp"

using namespace aeolis;
using namespace aeolis::archive;

namespace {

constexpr double entry_s = 397'000'000.0, light_s = 828.0;

v1::RunState run_with_clock() {
    v1::RunState run;
    run.set_run(7);
    run.set_entry_sclk(entry_s);
    run.set_light_time_s(light_s);
    run.mutable_clock()->set_sclk(entry_s);
    run.mutable_clock()->set_scet_us(scet_from_text("2012-219T05:10:46").value().microseconds);
    run.mutable_clock()->set_rate(1.0);
    return run;
}

std::string received(const char* text) {
    const auto ert = reception_of(text, clocks_of(run_with_clock()), "from");
    return ert ? day_of_year_text(*ert) : ert.error().message;
}

}  // namespace

TEST_CASE("a time of reception is the station's own, or a time of the vehicle and a light time", "[archive][times]") {
    const auto own = received("2012-219T05:24:34");
    for (const char* same : {"2012-219T05:24:34Z", "2012-08-06T05:24:34", "2012-08-06T07:24:34+02:00",
                             "ert:2012-219T05:24:34", "scet:2012-219T05:10:46", "397000000", "E+0:00", "E-0"}) {
        INFO(same);
        CHECK(received(same) == own);
    }
    CHECK(received("E+1:30") == received("2012-219T05:26:04"));
    CHECK_THAT(received("yesterday"), Catch::Contains("from: 'yesterday' is no instant"));
    CHECK_THAT(received("1e300"), Catch::Contains("is no instant"));
}

TEST_CASE("what leaves by a time of the vehicle leaves a light time earlier", "[archive][times]") {
    const auto clocks = clocks_of(run_with_clock());
    const auto left = departure_of("E+0:00", clocks, "release_at"), came = reception_of("E+0:00", clocks, "from");
    REQUIRE(left);
    REQUIRE(came);
    CHECK(came->microseconds - left->microseconds == static_cast<std::int64_t>(2e6 * light_s));
}

TEST_CASE("a run whose SCET nobody knows has times of reception in UTC alone", "[archive][times]") {
    v1::RunState run;
    run.set_entry_sclk(entry_s);
    CHECK(reception_of("2012-219T05:24:34", clocks_of(run), "from"));
    const auto none = reception_of("397000000", clocks_of(run), "from");
    REQUIRE(!none);
    CHECK_THAT(none.error().message, Catch::Contains("nobody knows which SCET the run has"));
}

TEST_CASE("a time from entry is refused where nobody knows when entry is", "[archive][times]") {
    v1::RunState run = run_with_clock();
    run.clear_entry_sclk();
    for (const auto& refused :
         {instant_of("E+1:30", run, "at").error().message, reception_of("E+1:30", clocks_of(run), "at").error().message,
          departure_of("E+1:30", clocks_of(run), "at").error().message})
        CHECK_THAT(refused, Catch::Contains("at: 'E+1:30' counts from entry, and nobody knows when the run has it"));
    CHECK(instant_of("397000000", run, "at"));
}
