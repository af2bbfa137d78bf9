// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_tracker.hpp"
#include "tests/support/tone_signal.hpp"

#include <algorithm>
#include <cmath>

namespace telemetry_carrier_tracker_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::samples_of;
using aeolis::tests::table;

namespace {

std::vector<CarrierHop> tracked(const simulation::XBandPath& path, double length_s, double from_hz,
                                double from_hzps = 0.0) {
    const HopLayout layout{path.rate_hz};
    CarrierTracker tracker{layout};
    tracker.start(0, from_hz, from_hzps);
    const auto samples = samples_of(path, {}, length_s);
    std::vector<CarrierHop> hops;
    for (std::size_t at = 0; at + static_cast<std::size_t>(layout.hop_samples()) <= samples.size() && !tracker.lost();
         at += static_cast<std::size_t>(layout.hop_samples()))
        tracker.push(std::span{samples}.subspan(at, static_cast<std::size_t>(layout.hop_samples())), hops);
    if (!tracker.lost()) tracker.finish(hops);
    return hops;
}

}  // namespace

TEST_CASE("hops are an eighth of a second, of 32 parts, whatever the rate", "[tones]") {
    for (const double rate_hz : {3000.0, 8192.0, 16384.0, 44100.0, 100000.0, 1e6}) {
        const HopLayout layout{rate_hz};
        CHECK(layout.hop_s() == Approx(0.125).epsilon(0.08));
        CHECK(layout.hop_samples() == 32 * layout.part_samples * layout.thinning);
        CHECK((layout.thinning == 1 || layout.thinned_rate_hz() >= 6000.0));
    }
}

TEST_CASE("each hop comes out once and in order, with the frequency of a swinging carrier", "[tones]") {
    simulation::XBandPath path;
    path.rate_hz = 8192.0;
    path.total_c_n0_dbhz = 22.0;
    std::vector<double> time_s, doppler_hz;
    for (double t = 0.0; t < 31.0; t += 0.25) {
        time_s.push_back(t);
        doppler_hz.push_back(200.0 * std::sin(0.3 * t));
    }
    path.doppler_hz = table(time_s, doppler_hz);
    const auto hops = tracked(path, 30.0, 0.0, 60.0);
    REQUIRE(hops.size() == 240);
    double squares = 0.0;
    for (std::size_t i = 0; i < hops.size(); ++i) {
        CHECK(hops[i].first_sample == static_cast<std::int64_t>(i) * 1024);
        CHECK(hops[i].found == (i < 238));  // the last two have no half window after them
        squares += std::pow(hops[i].frequency_hz - path.doppler_hz.at((static_cast<double>(i) + 0.5) * 0.125), 2);
    }
    CHECK(std::sqrt(squares / 240.0) < 0.5);
    CHECK(hops[120].lock == CarrierLock::locked);
    CHECK(10.0 * std::log10(hops[120].carrier_n0_hz) == Approx(22.0).margin(3.0));
}

TEST_CASE("a carrier that a parachute's opening makes swerve is followed without a break", "[tones]") {
    simulation::XBandPath path;
    path.rate_hz = 8192.0;
    path.total_c_n0_dbhz = 20.5;
    // The rate grows to 1000 Hz/s within 0.8 s, and fades.
    constexpr double opens_s = 10.0, opening_s = 0.8, step_s = 1.0 / 64.0;
    std::vector<double> time_s, doppler_hz;
    double hz = -500.0;
    for (double t = 0.0; t < 21.0; t += step_s) {
        time_s.push_back(t);
        doppler_hz.push_back(hz);
        const double opened = std::clamp((t - opens_s) / opening_s, 0.0, 1.0);
        hz += step_s * 1000.0 * opened * opened * (3.0 - 2.0 * opened) *
              std::exp(-std::max(t - opens_s - opening_s, 0.0) / 2.0);
    }
    path.doppler_hz = table(time_s, doppler_hz);
    const auto hops = tracked(path, 20.0, -500.0);
    REQUIRE(hops.size() == 160);
    int found = 0;
    for (std::size_t i = 80; i < 158; ++i) {
        CAPTURE(i);
        found += hops[i].found;
        if (hops[i].found)
            CHECK(std::abs(hops[i].frequency_hz - path.doppler_hz.at((static_cast<double>(i) + 0.5) * 0.125)) <
                  8.0 + 5.0 * hops[i].frequency_deviation_hz);
    }
    CHECK(found >= 76);
}

TEST_CASE("a carrier that ends is lost within 7 s, and no hop is missing", "[tones]") {
    simulation::XBandPath path;
    path.rate_hz = 8192.0;
    path.set_s = 10.0;
    const auto hops = tracked(path, 20.0, 0.0);
    REQUIRE(hops.size() > 80);
    CHECK(hops.size() <= 136);
    CHECK(hops[60].found);
    CHECK_FALSE(hops.back().found);
    CHECK(hops.back().lock == CarrierLock::coasting);
}

TEST_CASE("a weak carrier is followed by longer looks", "[tones]") {
    simulation::XBandPath path;
    path.rate_hz = 8192.0;
    path.total_c_n0_dbhz = 10.0;
    path.gain_db = table({0.0, 10.0, 30.0, 100.0}, {12.0, 12.0, 0.0, 0.0});
    const auto hops = tracked(path, 80.0, 0.0);
    REQUIRE(hops.size() == 640);
    int found = 0;
    for (std::size_t i = 320; i < hops.size(); ++i) found += hops[i].found;
    CHECK(found > 290);
    CHECK(hops[500].lock == CarrierLock::fluctuating);
}

}  // namespace telemetry_carrier_tracker_test
