// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/tone_station.hpp"

#include "simulation/links/x_band_front_end.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace telemetry_tone_station_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

constexpr double start_e_s = 100.0;
constexpr Ert entry{1'000'000 - 100'000'000};

/// A vehicle that sends the carrier, and from 15 s on tone 42 for one symbol; ground removes no Doppler.
struct Sky {
    simulation::XBandFrontEnd antenna;
    ToneStation station{tests::shipped_dictionary().mfsk, {}, entry};
    Received received;
    std::int64_t ticks = 0;
    double gain_db = 0.0;

    explicit Sky(double total_c_n0_dbhz) : antenna(tests::shipped_dictionary().mfsk, total_c_n0_dbhz, {}, 1, 0) {}

    void fly(double until_s, bool up) {
        for (; ticks < static_cast<std::int64_t>(until_s * 64.0); ++ticks) {
            const double now_s = static_cast<double>(ticks) / 64.0;
            simulation::XBandField field;
            field.ert = Ert{1'000'000 + ticks * 15625};
            field.e_s = start_e_s + now_s;
            field.doppler_hz = 30.0 * now_s;
            field.up = up;
            field.gain_db = gain_db;
            if (now_s >= 15.0 && now_s < 25.0) {
                field.tone = ToneId{42};
                field.tone_age_s = now_s - 15.0;
            }
            Downlink downlink;
            downlink.now = field.ert;
            downlink.x_band.push_back(antenna.sample(field));
            station.receive(downlink, received);
        }
    }
};

}  // namespace

TEST_CASE("a tone on a carrier that drifts is decoded from its samples and dated by them", "[tones][station]") {
    Sky sky{25.0};
    sky.fly(60.0, true);
    REQUIRE(sky.received.tones.size() == 1);
    const ReceivedTone& tone = sky.received.tones.front();
    CHECK(tone.tone == ToneId{42});
    CHECK(tone.lock == CarrierLock::locked);
    REQUIRE(tone.best);
    CHECK((*tone.best)[0].tone == 42);
    REQUIRE(tone.spectrum);
    CHECK(std::ranges::max_element(*tone.spectrum) - tone.spectrum->begin() == 42 / 2);
    CHECK(tone.likelihood > 0.9);
    CHECK(static_cast<double>(tone.start.microseconds) == Approx(16.0e6).margin(0.3e6));
    CHECK(tone.end.microseconds - tone.start.microseconds == 10'000'000);
    CHECK(tone.c_n0_dbhz == Approx(25.0).margin(1.5));
    CHECK(tone.doppler_hz == Approx(30.0 * 20.0).margin(10.0));  // in the middle of the symbol
}

TEST_CASE("the carrier is told eight times a second from its samples, with its deviation, and once when it is lost",
          "[tones][station][R54]") {
    Sky sky{25.0};
    sky.fly(40.0, true);
    sky.fly(60.0, false);
    const auto& told = sky.received.carrier;
    REQUIRE(told.size() > 8 * 36);
    for (std::size_t i = 0; i < told.size(); ++i) {
        const double now_s = static_cast<double>(told[i].middle.microseconds) * 1e-6 - 1.0;
        const double late_s = static_cast<double>(told[i].ert.microseconds - told[i].middle.microseconds) * 1e-6;
        CHECK(late_s > 0.0);
        CHECK(late_s < (told[i].estimate ? 2.5 : 7.5));  // longer windows are tried before it is given up
        if (told[i].estimate && now_s < 39.7) {
            const double sent_hz = 30.0 * (now_s - seconds_per_tick);  // the antenna's Doppler is a cycle old
            CHECK(told[i].estimate->residual_hz == Approx(sent_hz).margin(5.0 * told[i].estimate->sigma_hz));
            CHECK(told[i].estimate->sigma_hz < 0.5);
            CHECK(told[i].estimate->rate_hzps == Approx(30.0).margin(6.0));
            CHECK(told[i].estimate->c_n0_dbhz == Approx(25.0).margin(2.0));  // 1.4 dB more without a tone
        }
        if (now_s > 3.0 && now_s < 39.5) CHECK(told[i].estimate);
        if (now_s > 40.0) CHECK_FALSE(told[i].estimate);
        CHECK(told[i].estimate.has_value() ==
              (told[i].lock == CarrierLock::locked || told[i].lock == CarrierLock::fluctuating));
        CHECK((told[i].lock == CarrierLock::searching) == (i + 1 == told.size()));
    }
}

TEST_CASE("a symbol that nobody can hear leaves nothing, and no tone is made of noise", "[tones][station][R53]") {
    for (const bool too_weak : {false, true}) {
        Sky sky{too_weak ? 5.0 : 25.0};
        sky.fly(80.0, too_weak);
        CHECK(sky.received.tones.empty());
        REQUIRE(sky.received.links.size() == 1);
        CHECK_FALSE(sky.received.links.front().up);
    }
}

TEST_CASE("X-band is up while the receiver follows a carrier", "[tones][station][R53]") {
    Sky sky{25.0};
    sky.fly(20.0, true);
    REQUIRE(sky.received.links.size() == 1);
    CHECK(sky.received.links[0].link == x_band_link);
    CHECK(sky.received.links[0].up);
    sky.fly(60.0, false);
    REQUIRE(sky.received.links.size() == 2);
    CHECK_FALSE(sky.received.links[1].up);
    CHECK(sky.received.links[1].words.empty());
    sky.fly(80.0, true);
    CHECK(sky.received.links.back().up);
}

TEST_CASE("at 13 dB-Hz the link's state is the receiver's, and an erasure is of a symbol that it noticed",
          "[tones][station][R53]") {
    Sky sky{13.0};
    sky.gain_db = 12.0;
    sky.fly(12.0, true);
    REQUIRE(sky.received.links.size() == 1);
    CHECK(sky.received.links[0].up);
    sky.gain_db = 0.0;
    for (double until_s = 13.0; until_s < 80.0; until_s += 1.0) {
        sky.fly(until_s, true);
        CHECK(sky.received.links.back().up == (sky.station.status().lock != CarrierLock::searching));
    }
    for (const ReceivedTone& tone : sky.received.tones) CHECK(tone.best);
}

TEST_CASE("what the antenna gives away is missing in what is received", "[tones][station][R31]") {
    Sky sky{28.0};
    sky.gain_db = -4.0;
    sky.fly(60.0, true);
    REQUIRE(sky.received.tones.size() == 1);
    CHECK(sky.received.tones.front().tone == ToneId{42});
    CHECK(sky.received.tones.front().c_n0_dbhz == Approx(24.0).margin(1.0));
}

TEST_CASE("samples of a fixed oscillator give spectra whose carrier stands at the predicted frequency",
          "[tones][station][R54][R56]") {
    constexpr double rate_hzps = 30.0, offset_hz = 640.0;
    const auto spectra_of = [&](ToneStation station) {
        simulation::XBandFrontEnd antenna{tests::shipped_dictionary().mfsk, 35.0, {}, 1, 0};
        Received received;
        for (int tick = 0; tick < 20 * 64; ++tick) {
            simulation::XBandField field;
            field.ert = Ert{1'000'000 + tick * 15625};
            field.e_s = start_e_s + tick / 64.0;
            field.doppler_hz = offset_hz + rate_hzps * tick / 64.0;
            field.up = true;
            Downlink downlink;
            downlink.now = field.ert;
            downlink.x_band.push_back(antenna.sample(field));
            station.receive(downlink, received);
        }
        return received.spectra;
    };
    const auto middle_of = [](const ReceivedSpectrum& spectrum) {
        const auto& levels = spectrum.row.levels;
        const auto loudest = std::ranges::max_element(levels) - levels.begin();
        return spectrum.row.first_hz + spectrum.row.bin_hz * static_cast<double>(loudest);
    };
    const auto& mfsk = tests::shipped_dictionary().mfsk;
    const TimeTable expected =
        TimeTable::make({start_e_s, start_e_s + 30.0}, {offset_hz, offset_hz + 30.0 * rate_hzps}).value();
    const auto told = spectra_of({mfsk, {}, entry, {.expected_hz = expected}});
    REQUIRE(told.size() >= 18);
    for (const auto& spectrum : told) CHECK(std::abs(middle_of(spectrum)) <= spectrum.row.bin_hz);
    const auto not_told = spectra_of({mfsk, {}, entry});
    REQUIRE(not_told.size() == told.size());
    CHECK(middle_of(not_told.front()) == Approx(offset_hz).margin(2.0 * 32.0));
    CHECK(middle_of(not_told.back()) > offset_hz + 15.0 * rate_hzps);
}

TEST_CASE("when the transmitter goes off what waits is decided at once", "[tones][station]") {
    Sky sky{25.0};
    sky.fly(25.25, true);
    CHECK(sky.received.tones.empty());
    sky.station.receive({}, sky.received);
    REQUIRE(sky.received.tones.size() == 1);
    CHECK(sky.received.tones.front().tone == ToneId{42});
    CHECK_FALSE(sky.received.links.back().up);
}

TEST_CASE("a symbol ends ten seconds after it began, whether the carrier was cut short or went on",
          "[tones][station]") {
    for (const double off_s : {21.0, 25.25, 45.0}) {
        CAPTURE(off_s);
        Sky sky{28.0};
        sky.fly(off_s, true);
        sky.fly(off_s + 30.0, false);
        sky.station.receive({}, sky.received);
        REQUIRE(sky.received.tones.size() == 1);
        const ReceivedTone& tone = sky.received.tones.front();
        CHECK(tone.tone == ToneId{42});
        CHECK(static_cast<double>(tone.start.microseconds) == Approx(16.0e6).margin(0.5e6));
        CHECK(tone.end.microseconds - tone.start.microseconds == 10'000'000);
    }
}

}  // namespace telemetry_tone_station_test
