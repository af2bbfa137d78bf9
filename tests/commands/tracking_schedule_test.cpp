// SPDX-License-Identifier: Apache-2.0
#include "commands/tracking_schedule.hpp"

#include "tests/support/catch.hpp"

namespace commands_tracking_schedule_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

constexpr Ert at_minute(std::int64_t minutes) {
    return Ert{minutes * 60'000'000};
}

TrackingSchedule three_passes() {
    return TrackingSchedule{{{"DSS-43", at_minute(100), at_minute(200)},
                             {"DSS-14", at_minute(0), at_minute(50)},
                             {"DSS-34", at_minute(150), at_minute(180)}}};
}

}  // namespace

TEST_CASE("a station sees the vehicle from the begin of its pass up to its end", "[commands][tracking]") {
    const auto schedule = three_passes();
    CHECK_FALSE(schedule.always());
    CHECK(schedule.pass_at(at_minute(0))->station == "DSS-14");
    CHECK(schedule.sees(Ert{at_minute(50).microseconds - 1}));
    CHECK_FALSE(schedule.sees(at_minute(50)));
    CHECK(schedule.pass_at(at_minute(99)) == nullptr);
    CHECK(schedule.pass_at(at_minute(100))->station == "DSS-43");
}

TEST_CASE("of two stations that see the vehicle the one whose pass lasts longer is taken", "[commands][tracking]") {
    CHECK(three_passes().pass_at(at_minute(160))->station == "DSS-43");
}

TEST_CASE("why nothing can leave names the last pass and the next", "[commands][tracking]") {
    const auto schedule = three_passes();
    CHECK(schedule.next_after(at_minute(60))->station == "DSS-43");
    CHECK(schedule.refusal(at_minute(60)) ==
          "no station sees the vehicle at 2000-001T13:00:00.000: the last pass, of DSS-14, ended "
          "2000-001T12:50:00.000; the next, of "
          "DSS-43, is 2000-001T13:40:00.000 to 2000-001T15:20:00.000: give a release time within it");
    CHECK(schedule.next_after(at_minute(200)) == nullptr);
    CHECK_THAT(schedule.refusal(at_minute(200)),
               Catch::Contains("of DSS-43, ended") && Catch::EndsWith("none comes after it"));
    CHECK_THAT(schedule.refusal(at_minute(-1)), Catch::Contains("no pass was before; the next, of DSS-14"));
}

TEST_CASE("without a table some station always sees the vehicle, and none is named", "[commands][tracking]") {
    const TrackingSchedule none;
    CHECK(none.always());
    CHECK(none.sees(at_minute(-1000)));
    CHECK(none.pass_at(at_minute(0)) == nullptr);
}

TEST_CASE("after the last pass nobody sees the vehicle any more, in a gap somebody will", "[commands][tracking]") {
    const auto schedule = three_passes();
    CHECK_FALSE(schedule.over(at_minute(60)));
    CHECK_FALSE(schedule.over(at_minute(160)));
    CHECK_FALSE(schedule.over(Ert{at_minute(200).microseconds - 1}));
    CHECK(schedule.over(at_minute(200)));
    CHECK_FALSE(TrackingSchedule{}.over(at_minute(1000)));
}

}  // namespace commands_tracking_schedule_test
