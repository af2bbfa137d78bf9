// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tone_signal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace telemetry_tone_receiver_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::simulation::SentTone;
using aeolis::simulation::XBandPath;
using aeolis::tests::mfsk;
using aeolis::tests::received;
using aeolis::tests::samples_of;
using aeolis::tests::table;

namespace {

constexpr double rate_hz = 8192.0;

ToneReceiver receiver(double hz = rate_hz, TimeTable predict = {}, double start_s = 0.0) {
    auto made = ToneReceiver::make(mfsk, hz, {std::move(predict), start_s, {}, {}, {}});
    REQUIRE(made);
    return std::move(*made);
}

XBandPath steady(double frequency_hz = 350.0) {
    XBandPath path;
    path.rate_hz = rate_hz;
    path.doppler_hz = table({0.0, 1000.0}, {frequency_hz, frequency_hz});
    return path;
}

const std::vector<SentTone>& some_tones() {
    static const std::vector<SentTone> tones{{4.3, 17}, {14.3, 17}, {24.3, 255}, {40.1, 0}, {50.1, 128}, {63.0, 129}};
    return tones;
}

void check_tones(const std::vector<SentTone>& sent, const std::vector<ToneReception>& heard) {
    REQUIRE(heard.size() == sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        INFO("symbol " << i << " at " << heard[i].start_s);
        CHECK(heard[i].tone == sent[i].tone);
        CHECK(heard[i].start_s == Approx(sent[i].start_s).margin(0.2));
    }
}

}  // namespace

TEST_CASE("tones at 22 dB-Hz come out with beginning, level, Doppler, lock and the best five", "[tones][R31]") {
    auto ear = receiver();
    const auto heard = received(ear, samples_of(steady(), some_tones(), 80.0));
    check_tones(some_tones(), heard);
    for (const ToneReception& each : heard) {
        CHECK(each.total_c_n0_dbhz == Approx(22.0).margin(0.8));
        CHECK(each.doppler_hz == Approx(350.0).margin(0.5));
        CHECK(each.seen_fraction > 0.95);
        CHECK(each.evidence.best[0].likelihood > 0.999);
        CHECK(each.evidence.best[0].tone == *each.tone);
        CHECK(std::ranges::max_element(each.evidence.spectrum) - each.evidence.spectrum.begin() == *each.tone / 2);
    }
    CHECK(ear.status().acquisitions == 1);
}

TEST_CASE("the size of the blocks changes nothing", "[tones]") {
    const auto samples = samples_of(steady(), some_tones(), 80.0);
    auto whole = receiver(), crumbs = receiver();
    const auto at_once = received(whole, samples, samples.size());
    const auto in_crumbs = received(crumbs, samples, 777);
    REQUIRE(at_once.size() == in_crumbs.size());
    for (std::size_t i = 0; i < at_once.size(); ++i) {
        CHECK(at_once[i].start_s == in_crumbs[i].start_s);
        CHECK(at_once[i].evidence.log_likelihood_ratio == in_crumbs[i].evidence.log_likelihood_ratio);
    }
}

TEST_CASE("a copy of a receiver goes on as the first does", "[tones]") {
    const auto samples = samples_of(steady(), some_tones(), 80.0);
    auto first = receiver();
    first.push(std::span{samples}.first(samples.size() / 2));
    auto second = first;
    const auto rest = std::span{samples}.subspan(samples.size() / 2);
    for (auto* each : {&first, &second}) {
        each->push(rest);
        each->finish();
    }
    const auto heard = first.take(), again = second.take();
    REQUIRE(heard.size() == again.size());
    CHECK(heard.size() >= 3);
    for (std::size_t i = 0; i < heard.size(); ++i) {
        CHECK(heard[i].start_s == again[i].start_s);
        CHECK(heard[i].evidence.log_likelihood_ratio == again[i].evidence.log_likelihood_ratio);
    }
}

TEST_CASE("any rate that holds the tones will do", "[release][tones]") {
    for (const double hz : {4000.0, 10007.0, 44100.0, 100000.0}) {
        XBandPath path = steady(-200.0);
        path.rate_hz = hz;
        auto ear = receiver(hz);
        INFO(hz);
        check_tones({{4.3, 17}, {14.3, 254}}, received(ear, samples_of(path, {{4.3, 17}, {14.3, 254}}, 30.0)));
    }
}

TEST_CASE("a rate that is out of range, or cannot hold the tones, is refused by name", "[tones]") {
    for (const double hz : {0.0, -5.0, 100.0, 2.0e6, std::numeric_limits<double>::quiet_NaN()}) {
        const auto refused = ToneReceiver::make(mfsk, hz);
        REQUIRE_FALSE(refused);
        CHECK(refused.error().message.find("a rate of") == 0);
    }
    MfskWaveform high = mfsk;
    high.first_tone_hz = 2000.0;
    CHECK(ToneReceiver::make(high, 4000.0).error().message.find("does not hold tones") != std::string::npos);
}

TEST_CASE("samples said to be of half or twice their rate give no wrong tone", "[release][tones]") {
    for (const double said_hz : {0.5 * rate_hz, 2.0 * rate_hz}) {
        auto ear = receiver(said_hz);
        const auto heard = received(ear, samples_of(steady(), some_tones(), 80.0));
        CHECK(std::ranges::none_of(heard, [](const ToneReception& each) { return each.tone.has_value(); }));
        CHECK(ear.status().carrier_s > 10.0);
    }
}

TEST_CASE("silence, noise and broken numbers give nothing", "[tones]") {
    auto in_silence = receiver();
    CHECK(received(in_silence, std::vector<std::complex<float>>(400000)).empty());
    CHECK(in_silence.status().loudest == 0.0);
    CHECK(in_silence.status().lock == CarrierLock::searching);

    XBandPath noise = steady();
    noise.total_c_n0_dbhz = -100.0;
    auto in_noise = receiver();
    CHECK(received(in_noise, samples_of(noise, {}, 200.0)).empty());
    CHECK(in_noise.status().acquisitions == 0);

    auto in_broken = receiver();
    for (const float part : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38F})
        CHECK(received(in_broken, std::vector<std::complex<float>>(200000, {part, -part})).empty());
}

TEST_CASE("pulses a thousand million times louder cost nothing but themselves", "[tones]") {
    auto samples = samples_of(steady(), some_tones(), 80.0);
    std::mt19937 random{4};
    samples[0] = {1e38F, 0.0F};
    for (int i = 0; i < 500; ++i) samples[random() % samples.size()] = {i % 2 == 0 ? 1e30F : 3e38F, -1e9F};
    auto ear = receiver();
    check_tones(some_tones(), received(ear, samples));
}

TEST_CASE("a level that rises a million times is followed", "[tones]") {
    auto samples = samples_of(steady(), some_tones(), 80.0);
    for (std::size_t i = 0; i < samples.size() / 2; ++i) samples[i] *= 1e-3F;
    auto ear = receiver();
    const auto heard = received(ear, samples);
    REQUIRE(heard.size() >= 4);
    CHECK(heard.front().tone == some_tones().front().tone);
    CHECK(heard.back().tone == some_tones().back().tone);
}

TEST_CASE("a carrier without a tone gives no symbol", "[tones]") {
    auto ear = receiver();
    CHECK(received(ear, samples_of(steady(), {}, 100.0)).empty());
    CHECK(ear.status().carrier_s > 95.0);
}

TEST_CASE("a step of Doppler loses the carrier, and it is found again", "[tones]") {
    XBandPath path = steady();
    path.doppler_hz = table({0.0, 30.0, 30.5, 100.0}, {350.0, 350.0, -1400.0, -1380.0});
    const std::vector<SentTone> tones{{4.0, 100}, {14.0, 101}, {24.0, 102}, {36.0, 103}, {46.0, 104}};
    auto ear = receiver();
    const auto heard = received(ear, samples_of(path, tones, 70.0));
    CHECK(ear.status().acquisitions >= 2);
    for (const SentTone& sent : tones) {
        const auto found =
            std::ranges::find_if(heard, [&](const auto& each) { return std::abs(each.start_s - sent.start_s) < 3.0; });
        REQUIRE(found != heard.end());
        CHECK(found->tone == sent.tone);
    }
    CHECK(heard.size() == tones.size());
}

TEST_CASE("a predict is put back into the Doppler, and motion into the tones' frequencies", "[tones]") {
    XBandPath path = steady();
    path.start_s = 500.0;
    path.doppler_hz = table({0.0, 1000.0}, {-450000.0, -449000.0});
    path.predict_hz = table({0.0, 1000.0}, {-450300.0, -449200.0});
    const std::vector<SentTone> tones{{505.0, 255}, {515.0, 254}, {530.0, 3}};
    auto ear = receiver(rate_hz, path.predict_hz, 500.0);
    const auto heard = received(ear, samples_of(path, tones, 50.0));
    check_tones(tones, heard);
    CHECK(heard[0].doppler_hz == Approx(-449490.0).margin(1.0));
    CHECK(heard[0].evidence.log_likelihood_ratio > 250.0);
}

TEST_CASE("at Earth set the last whole tone is decoded and after it there is nothing", "[tones]") {
    XBandPath path = steady();
    path.set_s = 42.0;
    const std::vector<SentTone> tones{{5.0, 60}, {15.0, 61}, {40.5, 62}, {55.0, 63}};
    auto ear = receiver();
    const auto heard = received(ear, samples_of(path, tones, 80.0));
    REQUIRE(heard.size() >= 2);
    CHECK(heard[0].tone == 60);
    CHECK(heard[1].tone == 61);
    for (std::size_t i = 2; i < heard.size(); ++i) CHECK_FALSE(heard[i].tone);
    CHECK(ear.status().lock == CarrierLock::searching);
}

TEST_CASE("as the signal fades the lock says so before it is lost", "[tones]") {
    XBandPath path = steady();
    path.gain_db = table({0.0, 10.0, 60.0, 100.0}, {0.0, 0.0, -30.0, -30.0});
    auto ear = receiver();
    const auto samples = samples_of(path, {}, 100.0);
    bool fluctuated = false;
    for (std::size_t at = 0; at + 8192 <= samples.size(); at += 8192) {
        ear.push(std::span{samples}.subspan(at, 8192));
        fluctuated = fluctuated || ear.status().lock == CarrierLock::fluctuating;
    }
    CHECK(fluctuated);
    CHECK(ear.status().lock == CarrierLock::searching);
}

}  // namespace telemetry_tone_receiver_test
