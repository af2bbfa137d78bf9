// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_receiver_model.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace simulation_x_band_receiver_model_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

/// A carrier that sends tone 42 in all symbols from 10 s on.
struct Signal {
    double until_s = 61.0, c_n0_dbhz = 22.0;
    std::function<bool(double)> up = [](double) { return true; };
    std::function<double(double)> gain_db = [](double) { return 0.0; };
    std::function<bool(double)> station_out = [](double) { return false; };
};

telemetry::Downlink hear(const Signal& signal) {
    XBandReceiverModel receiver{signal.c_n0_dbhz, {}, 1, 0};
    telemetry::Downlink heard;
    for (int tick = 0; tick < static_cast<int>(signal.until_s * 64.0); ++tick) {
        XBandField field;
        field.e_s = tick / 64.0;
        field.ert = Ert{tick * 15625};
        heard.station_out = signal.station_out(field.e_s);
        field.up = signal.up(field.e_s) && !heard.station_out;
        field.gain_db = signal.gain_db(field.e_s);
        if (tick >= 640) {
            field.tone = ToneId{42};
            field.tone_age_s = tick % 640 / 64.0;
        }
        receiver.hear(field, heard);
    }
    return heard;
}

double s_of(Ert ert) {
    return static_cast<double>(ert.microseconds) * 1e-6;
}

}  // namespace

TEST_CASE("a receiver's model finds the carrier after its search, and decides each symbol from what it heard",
          "[simulation][tones][R53]") {
    const auto heard = hear({});
    REQUIRE(heard.links.size() == 1);
    CHECK(heard.links[0].up);
    CHECK(s_of(heard.links[0].ert) == Approx(1.0).margin(0.3));
    REQUIRE(heard.tones.size() == 5);
    for (std::size_t i = 0; i < heard.tones.size(); ++i) {
        const auto& tone = heard.tones[i];
        CHECK(tone.tone == ToneId{42});
        CHECK(s_of(tone.start) == Approx(10.0 * static_cast<double>(i + 1)));
        CHECK(s_of(tone.end) == Approx(s_of(tone.start) + 10.0));
        CHECK(tone.likelihood > 0.999);
        CHECK(tone.lock == CarrierLock::locked);
        CHECK(tone.c_n0_dbhz == Approx(22.0).margin(1.0));
        CHECK(std::abs(tone.doppler_hz) < 0.1);
        REQUIRE(tone.best);
        CHECK_FALSE(tone.spectrum);  // nothing was sampled
    }
}

TEST_CASE("of X-band that cannot be found the model says nothing but that it is down", "[simulation][tones][R53]") {
    for (const double c_n0_dbhz : {5.0, 13.0, 15.0}) {
        CAPTURE(c_n0_dbhz);
        const auto heard = hear({.c_n0_dbhz = c_n0_dbhz});
        CHECK(heard.tones.empty());
        CHECK(heard.carrier.empty());
        REQUIRE(heard.links.size() == 1);
        CHECK_FALSE(heard.links[0].up);
        CHECK(s_of(heard.links[0].ert) == Approx(10.0).margin(0.1));
    }
}

TEST_CASE("a carrier that sinks to 13 dB-Hz is up, and its tones are decided or erased, as long as it is found",
          "[simulation][tones][R53]") {
    const auto heard = hear({.until_s = 121.0, .gain_db = [](double e_s) { return e_s < 15.0 ? 0.0 : -9.0; }});
    REQUIRE(heard.links.size() >= 2);
    CHECK(heard.links[0].up);
    CHECK_FALSE(heard.links[1].up);
    const double lost_s = s_of(heard.links[1].ert);
    CHECK(lost_s > 16.0);  // a rule of the level alone would have it down at once
    // It is never found again: the search needs more.
    CHECK(heard.links.size() == 2);
    const auto found_in = [&](double from_s, double to_s) {
        return std::ranges::count_if(heard.carrier, [&](const auto& each) {
            return each.estimate && s_of(each.ert) >= from_s && s_of(each.ert) < to_s;
        });
    };
    for (const auto& tone : heard.tones) {
        CAPTURE(s_of(tone.start), lost_s);
        CHECK(found_in(s_of(tone.start), s_of(tone.end) + 0.1) > 0);  // no row where nothing was heard
        if (s_of(tone.end) > lost_s) CHECK(tone.lock == CarrierLock::searching);
        if (tone.tone) CHECK(*tone.tone == ToneId{42});
    }
    for (double start_s = 10.0; start_s < lost_s - 4.0; start_s += 10.0)
        CHECK(std::ranges::any_of(heard.tones,
                                  [&](const auto& tone) { return std::abs(s_of(tone.start) - start_s) < 0.1; }));
}

TEST_CASE("a symbol heard for less than a quarter is erased, one heard for half is decided",
          "[simulation][tones][R53]") {
    const auto erased = hear({.until_s = 21.0, .up = [](double e_s) { return e_s < 12.0; }});
    REQUIRE(erased.tones.size() == 1);
    CHECK_FALSE(erased.tones[0].tone);
    CHECK_FALSE(erased.tones[0].best);
    const auto decided = hear({.until_s = 21.0, .up = [](double e_s) { return e_s < 15.0; }});
    REQUIRE(decided.tones.size() == 1);
    CHECK(decided.tones[0].tone == ToneId{42});
    REQUIRE(decided.links.size() == 2);
    CHECK(s_of(decided.links[1].ert) == Approx(16.5).margin(0.7));  // lost after 1.5 s without it
}

TEST_CASE("a station that is out tells X-band as down at once, and as it finds it afterwards", "[simulation][faults]") {
    const auto heard = hear({.until_s = 41.0, .station_out = [](double e_s) { return e_s >= 20.0 && e_s < 30.0; }});
    REQUIRE(heard.links.size() == 3);
    CHECK_FALSE(heard.links[1].up);
    CHECK(s_of(heard.links[1].ert) == Approx(20.0).margin(0.05));
    CHECK(heard.links[2].up);
    CHECK(s_of(heard.links[2].ert) == Approx(32.5).margin(2.0));
}

TEST_CASE("a copied receiver's model continues alike", "[simulation][tones]") {
    XBandReceiverModel one{22.0, {}, 1, 0};
    telemetry::Downlink by_one, by_other;
    std::optional<XBandReceiverModel> other;
    for (int tick = 0; tick < 20 * 64; ++tick) {
        if (tick == 700) {
            other = one;
            by_one.clear();
        }
        XBandField field;
        field.e_s = tick / 64.0;
        field.ert = Ert{tick * 15625};
        field.up = true;
        field.tone = ToneId{42};
        field.tone_age_s = tick % 640 / 64.0;
        one.hear(field, by_one);
        if (other) other->hear(field, by_other);
    }
    REQUIRE(by_one.carrier.size() == by_other.carrier.size());
    REQUIRE_FALSE(by_one.carrier.empty());
    for (std::size_t i = 0; i < by_one.carrier.size(); ++i)
        CHECK(by_one.carrier[i].estimate->residual_hz == by_other.carrier[i].estimate->residual_hz);
}

}  // namespace simulation_x_band_receiver_model_test
