// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/doppler_watch.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace telemetry_doppler_watch_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using Feature = SeenByDoppler::Feature;

namespace {

constexpr double sigma_hz = 0.07, late_s = 0.3;
constexpr Ert entry{1'000'000'000};

/// A made-up landing. It resembles a real one in the size of its features alone.
struct Flight {
    double drag_s = 30.0, parachute_s = 250.0, heatshield_s = 272.0;
    double swing_hz = 0.0, swings_per_s = 1.0;  ///< under the parachute

    double doppler_hz(double t) const {
        double hz = -15.0 * t;
        // The density grows by e in some seconds; once the brakes are on, they are even.
        constexpr double growth_s = 6.0, grows_s = 30.0, grown_hzps = 4.0 / growth_s * 147.4;
        const double felt_s = std::clamp(t - drag_s, 0.0, grows_s) / growth_s;
        hz += 4.0 * (std::expm1(felt_s) - felt_s) + grown_hzps * std::max(0.0, t - drag_s - grows_s);
        const double open_s = t - parachute_s;
        if (open_s > 0.0) hz += 900.0 * std::min(open_s, 1.0) - 50.0 * std::max(0.0, open_s - 1.0);
        if (open_s > 1.0) hz += swing_hz * std::sin(2.0 * 3.14159265 * swings_per_s * open_s);
        return hz + 12.0 * std::max(0.0, t - heatshield_s);
    }
    TimeTable predict() const {
        std::vector<double> time_s, hz;
        for (double t = -60.0; t < 330.0; t += 0.0625) {
            time_s.push_back(t);
            hz.push_back(doppler_hz(t));
        }
        return *TimeTable::make(std::move(time_s), std::move(hz));
    }
};

/// What is told of the flight until Earth sets.
std::vector<SeenByDoppler> watch(
    const TimeTable& predict_hz, const Flight& flight,
    const std::function<bool(double)>& found = [](double) { return true; }, double wrong_hz = 0.0) {
    DopplerWatch doppler{predict_hz, entry};
    std::minstd_rand random{1};
    std::vector<SeenByDoppler> all;
    for (double t = -30.0; t < 298.0; t += 0.125) {
        ReceivedCarrier carrier;
        carrier.middle = {entry.microseconds + std::llround(t * 1.0e6)};
        carrier.ert = {carrier.middle.microseconds + std::llround(late_s * 1.0e6)};
        carrier.predict_hz = predict_hz.at(t);
        const double even = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
        double hz = flight.doppler_hz(t) - carrier.predict_hz + even * sigma_hz * std::sqrt(12.0);
        if (wrong_hz != 0.0 && static_cast<int>(std::lround(t * 8.0)) % 16 < 2) hz += wrong_hz;
        if (found(t)) carrier.estimate = {hz, sigma_hz, 0.0, 22.0};
        if (const auto seen = doppler.hear(carrier)) all.push_back(*seen);
    }
    return all;
}

double e_s(Ert ert) {
    return static_cast<double>(ert.microseconds - entry.microseconds) * 1.0e-6;
}

bool has(const std::vector<SeenByDoppler>& all, Feature feature) {
    return std::ranges::count(all, feature, &SeenByDoppler::feature) > 0;
}

/// The part of a made-up entry with reversals, at which the lift turns from one side to the other.
struct Braking {
    std::vector<double> reversals_s;
    double denser = 1.0;  ///< air than predicted

    TimeTable doppler_hz() const {
        std::vector<double> time_s, hz;
        double now_hz = -450'000.0;
        constexpr double step_s = 0.0625, turn_s = 9.0;
        for (double t = 45.0; t < 170.0; t += step_s) {
            double logarithm = std::log(denser);
            for (std::size_t i = 0; i < reversals_s.size(); ++i) {
                const double since = std::clamp((t - reversals_s[i]) / turn_s, -0.5, 0.5);
                logarithm += (i % 2 == 0 ? 0.15 : -0.2) * (0.5 + 0.5 * std::sin(3.14159265 * since));
            }
            now_hz += step_s * 2500.0 * std::exp(logarithm - 0.0008 * (t - 82.0) * (t - 82.0));
            time_s.push_back(t);
            hz.push_back(now_hz);
        }
        return *TimeTable::make(std::move(time_s), std::move(hz));
    }
};

std::vector<SeenByDoppler> watch_braking(DopplerWatch watch, const TimeTable& predict_hz, const TimeTable& flown_hz,
                                         double found_from_s = 50.0) {
    std::minstd_rand random{1};
    std::vector<SeenByDoppler> all;
    for (double t = found_from_s; t < 160.0; t += 0.125) {
        ReceivedCarrier carrier;
        carrier.middle = {entry.microseconds + std::llround(t * 1.0e6)};
        carrier.ert = {carrier.middle.microseconds + std::llround(late_s * 1.0e6)};
        carrier.predict_hz = predict_hz.at(t);
        const double even = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
        carrier.estimate = {flown_hz.at(t) - carrier.predict_hz + even * sigma_hz * std::sqrt(12.0), sigma_hz, 0.0,
                            22.0};
        if (const auto seen = watch.hear(carrier)) all.push_back(*seen);
    }
    return all;
}

}  // namespace

TEST_CASE("drag, parachute and heatshield are seen by Doppler once each, the two steps within three seconds, where the "
          "flight has them and not where the predict does",
          "[station][tones][R54]") {
    const Flight expected, flown{31.0, 256.0, 279.0};
    const auto seen = watch(expected.predict(), flown);
    REQUIRE(seen.size() == 3);
    const std::vector<std::pair<Feature, double>> true_s{
        {Feature::entry, flown.drag_s}, {Feature::parachute, 256.0}, {Feature::heatshield, 279.0}};
    for (std::size_t i = 0; i < 3; ++i) {
        CAPTURE(i, e_s(seen[i].at), e_s(seen[i].ert), seen[i].evidence_hz, seen[i].sigma_hz);
        CHECK(seen[i].feature == true_s[i].first);
        CHECK(e_s(seen[i].at) > true_s[i].second);
        CHECK(e_s(seen[i].ert) < true_s[i].second + (i == 0 ? 25.0 : 3.0));  // drag grows slowly
        CHECK(seen[i].ert.microseconds - seen[i].at.microseconds >= std::llround((late_s + 0.25) * 1.0e6));
        CHECK(seen[i].evidence_hz > 4.0 * seen[i].sigma_hz);
        CHECK(seen[i].sigma_hz > sigma_hz);
    }
}

TEST_CASE("what does not come is not seen by Doppler, whatever is expected", "[station][tones][R54]") {
    const Flight expected;
    const auto predict_hz = expected.predict();
    CHECK(watch(predict_hz, {1e9, 1e9, 1e9}).empty());
    const auto closed = watch(predict_hz, {30.0, 1e9, 1e9});
    CHECK(closed.size() == 1);
    CHECK(watch(predict_hz, {30.0, 250.0, 1e9}).size() == 2);
    CHECK(watch(predict_hz, {30.0, 1e9, 272.0}).size() == 1);  // a small step shows no heatshield before the parachute
    CHECK(watch(predict_hz, {30.0, 310.0, 320.0}).size() == 1);  // after Earth's set
}

TEST_CASE("what the predict does not show is not looked for", "[station][tones]") {
    const Flight flown;
    CHECK(watch({}, flown).empty());
    const Flight no_parachute{30.0, 1e9, 1e9};
    const DopplerWatch doppler{no_parachute.predict(), entry};
    CHECK(doppler.expected_s(Feature::entry));
    CHECK_FALSE(doppler.expected_s(Feature::parachute));
    CHECK_FALSE(doppler.expected_s(Feature::heatshield));
    CHECK(watch(no_parachute.predict(), flown).size() == 1);
}

TEST_CASE("a carrier that was not found over a feature, or only after it, does not show it", "[station][tones][R54]") {
    const Flight flown;
    const auto predict_hz = flown.predict();
    CHECK_FALSE(has(watch(predict_hz, flown, [](double t) { return t < 245.0 || t > 256.0; }), Feature::parachute));
    CHECK_FALSE(has(watch(predict_hz, flown, [](double t) { return t > 251.5; }), Feature::parachute));
    CHECK(watch(predict_hz, flown, [](double) { return false; }).empty());
    // Antennas are handed over shortly before, and the receiver often loses it for a moment while the parachute opens.
    CHECK(has(watch(predict_hz, flown, [](double t) { return t > 248.6 && (t < 250.2 || t > 251.4); }),
              Feature::parachute));
    CHECK(has(watch(predict_hz, flown, [](double t) { return t < 250.2 || t > 251.4; }), Feature::parachute));
}

TEST_CASE("a carrier that swings, and estimates that are wrong, show no feature", "[station][tones][R54]") {
    for (const double swings_per_s : {0.5, 0.7, 1.0, 1.4, 2.0})
        for (const double swing_hz : {5.0, 15.0, 40.0}) {
            CAPTURE(swings_per_s, swing_hz);
            Flight swinging{30.0, 250.0, 1e9};
            swinging.swing_hz = swing_hz;
            swinging.swings_per_s = swings_per_s;
            CHECK_FALSE(has(watch(Flight{}.predict(), swinging), Feature::heatshield));
        }
    const auto wrong = watch(Flight{}.predict(), {1e9, 1e9, 1e9}, [](double) { return true; }, 700.0);
    CHECK(wrong.empty());
}

TEST_CASE("reversals are seen by Doppler where the flight has them, when expected or not, and none where it has none",
          "[station][tones][R54]") {
    const std::vector<double> predicted_s{78.0, 99.0, 127.0};
    const Braking expected{predicted_s};
    const auto predict_hz = expected.doppler_hz();
    const DopplerWatch watch{predict_hz, entry, predicted_s};
    const std::array<Feature, 3> features{Feature::first_reversal, Feature::second_reversal, Feature::third_reversal};
    for (std::size_t i = 0; i < features.size(); ++i) {
        REQUIRE(watch.expected_s(features[i]));
        CHECK(*watch.expected_s(features[i]) == Approx(predicted_s[i]).margin(1.0));
    }
    CHECK_FALSE(watch.expected_s(Feature::fourth_reversal));

    const std::vector<std::vector<double>> flown{{78.0, 99.0, 127.0}, {77.0, 97.0, 120.0}, {79.5, 101.0, 134.0},
                                                 {78.0, 99.0, 1e9},   {78.0, 1e9, 127.0},  {1e9, 1e9, 1e9}};
    for (const auto& turns_s : flown) {
        CAPTURE(turns_s);
        std::map<Feature, SeenByDoppler> seen;
        const auto told = watch_braking(watch, predict_hz, Braking{turns_s, 1.03}.doppler_hz());
        for (const auto& each : told) CHECK(seen.emplace(each.feature, each).second);
        for (std::size_t i = 0; i < features.size(); ++i) {
            CAPTURE(i);
            REQUIRE(seen.contains(features[i]) == (turns_s[i] < 1e6));
            if (turns_s[i] > 1e6) continue;
            const auto& each = seen.at(features[i]);
            CHECK(e_s(each.ert) > turns_s[i] - 4.0);  // lift turns for nine seconds
            CHECK(e_s(each.ert) < turns_s[i] + 3.0);
            CHECK(each.ert.microseconds - each.at.microseconds >= std::llround((late_s + 0.25) * 1.0e6));
            CHECK(std::abs(each.evidence_hz) > 4.0 * each.sigma_hz);
            CHECK((each.evidence_hz > 0.0) == (i != 1));  // towards Earth, or away
        }
    }
    // Reversals that nobody predicts are not looked for.
    CHECK(watch_braking(DopplerWatch{predict_hz, entry}, predict_hz, predict_hz).empty());
    // A carrier that is found only after it.
    const auto late = watch_braking(watch, predict_hz, predict_hz, 80.0);
    CHECK_FALSE(has(late, Feature::first_reversal));
    CHECK(has(late, Feature::second_reversal));
}

TEST_CASE("a copied watch continues alike", "[station][tones]") {
    const Flight flown;
    const auto predict_hz = flown.predict();
    DopplerWatch one{predict_hz, entry};
    std::optional<DopplerWatch> other;
    int seen = 0;
    for (double t = 200.0; t < 260.0; t += 0.125) {
        if (t >= 249.0 && !other) other = one;
        ReceivedCarrier carrier;
        carrier.middle = carrier.ert = {entry.microseconds + std::llround(t * 1.0e6)};
        carrier.predict_hz = predict_hz.at(t);
        carrier.estimate = {0.0, sigma_hz, 0.0, 22.0};
        const auto by_one = one.hear(carrier);
        seen += by_one ? 1 : 0;
        if (other) CHECK(other->hear(carrier).has_value() == by_one.has_value());
    }
    CHECK(seen == 1);
}

}  // namespace telemetry_doppler_watch_test
