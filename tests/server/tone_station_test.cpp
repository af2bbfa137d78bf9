// SPDX-License-Identifier: Apache-2.0
#include "server/station/tone_station.hpp"

#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace server_tone_station_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

constexpr double start_e_s = 100.0;

/// A vehicle that sends the carrier, and from 15 s on tone 42 for one symbol; ground removes no Doppler.
struct Sky {
    ToneStation station;
    std::vector<simulation::ReceivedTone> decided;
    std::int64_t ticks = 0;
    double gain_db = 0.0;

    explicit Sky(double total_c_n0_dbhz)
        : station(tests::shipped_dictionary().mfsk, radio(total_c_n0_dbhz), {}, 1, 0) {}

    static simulation::Radio radio(double total_c_n0_dbhz) {
        simulation::Radio radio;
        radio.x_band_c_n0_dbhz = total_c_n0_dbhz;
        return radio;
    }
    void fly(double until_s, bool up) {
        for (; ticks < static_cast<std::int64_t>(until_s * 64.0); ++ticks) {
            const double now_s = static_cast<double>(ticks) / 64.0;
            simulation::CycleReport report;
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
            report.x_band.push_back(field);
            if (now_s == 25.0) {
                simulation::ReceivedTone symbol;
                symbol.sent = ToneId{42};
                symbol.sent_at = Sclk{115.0};
                symbol.start = Ert{16'000'000};
                symbol.end = Ert{26'000'000};
                report.symbols.push_back(symbol);
            }
            station.receive(report, decided);
        }
    }
};

}  // namespace

TEST_CASE("a tone on a carrier that drifts is decoded from its samples, dated by them, with the symbol it is",
          "[tones][station]") {
    Sky sky{25.0};
    sky.fly(60.0, true);
    REQUIRE(sky.decided.size() == 1);
    const simulation::ReceivedTone& tone = sky.decided.front();
    CHECK(tone.tone == ToneId{42});
    CHECK(tone.sent == ToneId{42});
    CHECK(tone.sent_at == Sclk{115.0});
    CHECK(tone.lock == CarrierLock::locked);
    REQUIRE(tone.best);
    CHECK((*tone.best)[0].tone == 42);
    REQUIRE(tone.spectrum);
    CHECK(std::ranges::max_element(*tone.spectrum) - tone.spectrum->begin() == 42 / 2);
    CHECK(tone.likelihood > 0.9);
    CHECK(static_cast<double>(tone.start.microseconds) == Approx(16.0e6).margin(0.3e6));
    CHECK(tone.c_n0_dbhz == Approx(25.0).margin(1.5));
    CHECK(tone.doppler_hz == Approx(30.0 * 20.0).margin(10.0));  // in the middle of the symbol
}

TEST_CASE("a symbol that nobody can hear is an erasure in the end, and no tone is made of noise", "[tones][station]") {
    Sky sky{25.0};
    sky.fly(80.0, false);
    REQUIRE(sky.decided.size() == 1);
    CHECK_FALSE(sky.decided.front().tone);
    CHECK(sky.decided.front().sent == ToneId{42});
}

TEST_CASE("what the antenna gives away is missing in what is received", "[tones][station][R31]") {
    Sky sky{28.0};
    sky.gain_db = -4.0;
    sky.fly(60.0, true);
    REQUIRE(sky.decided.size() == 1);
    CHECK(sky.decided.front().tone == ToneId{42});
    CHECK(sky.decided.front().c_n0_dbhz == Approx(24.0).margin(1.0));
}

TEST_CASE("when the transmitter goes off what waits is decided at once", "[tones][station]") {
    Sky sky{25.0};
    sky.fly(25.25, true);
    CHECK(sky.decided.empty());
    sky.station.receive({}, sky.decided);
    REQUIRE(sky.decided.size() == 1);
    CHECK(sky.decided.front().tone == ToneId{42});
}

TEST_CASE(
    "a landing's tones are decoded from its waveform, none wrong, and what UHF brought through bursts of errors is in "
    "the recording, bit for bit",
    "[tones][station][R31]") {
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.radio.tones_from_samples = true;
    scenario.radio.uhf_loss_fraction = 0.05;
    Rehearsal rehearsal{scenario, 1, 0, tests::shipped_dictionary()};
    std::set<std::string> outages;
    while (!rehearsal.finished())
        for (const auto& link : rehearsal.step().links)
            if (!link.up) outages.insert(link.link.name + ": " + link.reason);
    CHECK(rehearsal.outcome() == "touchdown");
    CHECK(rehearsal.recording_progress() == 1.0);
    const auto silent = [&](const std::string& beginning) {
        return std::ranges::any_of(outages, [&](const auto& words) { return words.starts_with(beginning); });
    };
    CHECK(silent("uhf_live: plasma blackout: predicted"));
    CHECK(silent("x_band: Earth set: predicted"));
    CHECK(rehearsal.run_start(0.0).tone_model == "signal");
    const auto& tones = rehearsal.tones();
    CHECK(tones.sent > 30);
    CHECK(tones.wrong == 0);
    CHECK(tones.missed <= 2);  // Earth sets in one, and the parachute may cost one
    const auto proof = rehearsal.proof();
    CHECK(proof.holds());
    CHECK(proof.realtime > 5000);
    CHECK(rehearsal.station().links().at(0).pltus.counters().missing_frames > 10);
    CHECK(rehearsal.station().links().at(0).pltus.counters().bad_crc > 10);

    scenario.radio.tones_from_samples.reset();  // nobody chooses: drawn
    Rehearsal drawn{scenario, 1, 0, tests::shipped_dictionary()};
    while (!drawn.finished()) drawn.step();
    CHECK(drawn.run_start(0.0).tone_model == "statistical");
    CHECK(drawn.digest() == rehearsal.digest());  // what is recorded on board does not depend on who listens
}

}  // namespace server_tone_station_test
