// SPDX-License-Identifier: Apache-2.0
#include "server/tones/reception_check.hpp"

#include "tests/support/catch.hpp"

namespace server_reception_check_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("a recording in which nothing usable was heard is a fault, in one line that says what to look at",
          "[tones][R55]") {
    HeardRecording good;
    good.status.loudest = 1.0;
    good.status.carrier_s = 40.0;
    good.tones = 3;
    good.length_s = 45.0;
    const SampleClaims claims{8192.0, "ci16", {}, {}, 10.0};
    CHECK(check_reception(good, claims).empty());

    const auto only = [&](const HeardRecording& heard) {
        const auto remarks = check_reception(heard, claims);
        REQUIRE(remarks.size() == 1);
        CHECK(remarks.front().fault);
        return remarks.front().text;
    };
    auto silent = good;
    silent.status.loudest = 0.0;
    CHECK(only(silent) == "silence, 45.0 s of it");
    auto noise = good;
    noise.status.carrier_s = 0.0;
    noise.tones = 0;
    CHECK(only(noise) == "no carrier was heard within 45.0 s; rate 8192 Hz, format ci16");
    auto music = good;
    music.tones = 0;
    CHECK(only(music) == "a carrier for 40.0 s, and no tone on it; is 8192 Hz its rate, to 600 ppm?");
    auto slow = music;  // by more than 600 ppm: what is found is erased
    slow.erasures = 1;
    CHECK(only(slow) == "a carrier for 40.0 s, and no tone on it, 1 erased; is 8192 Hz its rate, to 600 ppm?");
    auto cut = good;
    cut.left_over_octets = 3;
    CHECK(only(cut) == "3 octets behind the last whole sample: truncated, or not ci16");
    auto wrong_rate = good;
    wrong_rate.status.contradicted = 2;
    CHECK_THAT(only(wrong_rate), Catch::Contains("the rate is wrong"));

    auto hidden = music;
    hidden.status.standing_hz = {0.0, 40.04};
    CHECK_THAT(only(hidden), Catch::Contains("to 600 ppm? What stands still may be a line that hides the carrier: "
                                             "--exclude 0.0,40.0"));
    auto beside = good;
    beside.status.left_out_hz = {0.0};
    const auto left_out = check_reception(beside, claims);
    REQUIRE(left_out.size() == 1);
    CHECK_FALSE(left_out.front().fault);
    CHECK(left_out.front().text == "lines that stand still beside the carrier were left out, at 0.0 Hz");
    auto elsewhere = claims;
    elsewhere.carrier_hz = 8.4e9;
    for (const auto& [middle_hz, faults] : {std::pair{2.2e9, 1U}, {8.4e9, 0U}, {8.4e9 + 450e3, 0U}}) {
        elsewhere.frequency_hz = middle_hz;
        const auto told = check_reception(good, elsewhere);
        REQUIRE(told.size() == faults);
        if (faults > 0)
            CHECK(told.front().text == "the middle of the band is 2200000000 Hz, and tones are sent at 8400000000 Hz");
    }

    auto gap = good;
    gap.status.gap_s = 2.0;
    const auto told = check_reception(gap, claims);
    REQUIRE(told.size() == 1);
    CHECK_FALSE(told.front().fault);
}

TEST_CASE("a carrier that still moves by the Doppler that was said to be removed is a fault", "[tones][R55]") {
    HeardRecording heard;
    heard.status.loudest = heard.status.carrier_s = 1.0;
    heard.tones = 3;
    for (int second = 0; second < 100; ++second)
        heard.add({.time_s = second * 1.0, .lock = CarrierLock::locked, .frequency_hz = 10.0 * second});
    heard.add({.time_s = 99.5, .lock = CarrierLock::locked, .frequency_hz = 1.0e6});  // one a second is kept
    const TimeTable doppler = TimeTable::make({0.0, 100.0}, {0.0, 1000.0}).value();
    const auto remarks = check_reception(heard, {8192.0, "ci16", doppler, {}, 10.0});
    REQUIRE(remarks.size() == 1);
    CHECK(remarks.front().text == "the Doppler of --predict is still in the samples; give it by --expected");
    CHECK(check_reception(heard, {8192.0, "ci16", {}, doppler, 10.0}).empty());
}

}  // namespace server_reception_check_test
