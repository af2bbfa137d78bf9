// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/carrier_model.hpp"

#include "simulation/links/x_band_link.hpp"
#include "telemetry/station/tone_station.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace simulation_carrier_model_test {

using namespace aeolis;
using namespace aeolis::simulation;
using telemetry::ReceivedCarrier;

namespace {

constexpr Ert entry{};

/// The estimates of a model and of the receiver of samples, of one carrier without a predict.
struct Both {
    std::vector<ReceivedCarrier> model, samples;
};

struct Flight {
    double until_s = 60.0, total_c_n0_dbhz = 22.0;
    std::function<double(double)> doppler_hz = [](double) { return 0.0; };
    std::function<bool(double)> up = [](double) { return true; };
    bool with_samples = true;
    TimeTable predict_hz{};
};

Both hear(const Flight& flight) {
    const auto& waveform = tests::shipped_dictionary().mfsk;
    CarrierModel model{flight.total_c_n0_dbhz, flight.predict_hz, 1, 0};
    XBandFrontEnd antenna{waveform, flight.total_c_n0_dbhz, flight.predict_hz, 1, 0};
    telemetry::ToneStation station{waveform, flight.predict_hz, entry};
    telemetry::Received received;
    Both both;
    for (int tick = 0; tick < static_cast<int>(flight.until_s * 64.0); ++tick) {
        XBandField field;
        field.e_s = tick / 64.0;
        field.ert = Ert{tick * 15625};
        field.doppler_hz = flight.doppler_hz(field.e_s);
        field.up = flight.up(field.e_s);
        if (const auto told = model.hear(field)) both.model.push_back(*told);
        if (!flight.with_samples) continue;
        telemetry::Downlink downlink;
        downlink.now = field.ert;
        downlink.x_band.push_back(antenna.sample(field));
        station.receive(downlink, received);
    }
    both.samples = std::move(received.carrier);
    return both;
}

struct Spread {
    int count = 0;
    double deviation_hz = 0.0, told_hz = 0.0, c_n0_dbhz = 0.0, rate_hzps = 0.0;
};

/// How far the residuals lie from 0, and how far they are told to.
Spread spread(const std::vector<ReceivedCarrier>& told) {
    Spread all;
    for (const auto& each : told) {
        if (!each.estimate || each.lock != CarrierLock::locked) continue;
        ++all.count;
        all.deviation_hz += each.estimate->residual_hz * each.estimate->residual_hz;
        all.told_hz += each.estimate->sigma_hz * each.estimate->sigma_hz;
        all.c_n0_dbhz += std::pow(10.0, 0.1 * each.estimate->c_n0_dbhz);
        all.rate_hzps += each.estimate->rate_hzps * each.estimate->rate_hzps;
    }
    all.deviation_hz = std::sqrt(all.deviation_hz / all.count);
    all.told_hz = std::sqrt(all.told_hz / all.count);
    all.c_n0_dbhz = 10.0 * std::log10(all.c_n0_dbhz / all.count);
    all.rate_hzps = std::sqrt(all.rate_hzps / all.count);
    return all;
}

}  // namespace

TEST_CASE("the model's carrier is as uncertain as it says, and as that of the receiver of samples",
          "[simulation][tones][R54]") {
    for (const double c_n0_dbhz : {22.0, 26.0}) {
        Flight flight;
        flight.total_c_n0_dbhz = c_n0_dbhz;
        flight.until_s = 120.0;
        const auto both = hear(flight);
        const auto model = spread(both.model), samples = spread(both.samples);
        CAPTURE(c_n0_dbhz, model.deviation_hz, samples.deviation_hz, model.told_hz, samples.told_hz, model.rate_hzps,
                samples.rate_hzps, model.c_n0_dbhz, samples.c_n0_dbhz, model.count, samples.count);
        CHECK(model.count > 8 * 110);
        CHECK(samples.count > 8 * 110);
        CHECK(model.deviation_hz / model.told_hz == Approx(1.0).margin(0.15));
        CHECK(samples.deviation_hz / samples.told_hz == Approx(1.0).margin(0.15));
        CHECK(model.deviation_hz / samples.deviation_hz == Approx(1.0).margin(0.2));
        CHECK(model.rate_hzps / samples.rate_hzps == Approx(1.0).margin(0.25));
        const double alone_dbhz = c_n0_dbhz - XBandLink::carrier_power_db();  // told as if it carried a tone
        CHECK(model.c_n0_dbhz == Approx(alone_dbhz).margin(0.4));
        CHECK(samples.c_n0_dbhz == Approx(alone_dbhz).margin(0.4));
    }
}

TEST_CASE("the model's carrier is lost when it goes, found again when it comes, and told in between to be neither",
          "[simulation][tones][R53][R54]") {
    Flight flight;
    flight.up = [](double t) { return t < 20.0 || t >= 30.0; };
    for (const auto& told : {hear(flight).model, hear(flight).samples}) {
        int lost = 0;
        for (const auto& each : told) {
            const double at_s = static_cast<double>(each.middle.microseconds) * 1e-6;
            if (at_s > 20.5 && at_s < 29.5) CHECK_FALSE(each.estimate);
            if (at_s > 23.0 && at_s < 29.5) CHECK(each.lock == CarrierLock::searching);
            if (each.lock != CarrierLock::searching) continue;
            ++lost;
            CHECK_FALSE(each.estimate);
        }
        CHECK(lost == 1);
        REQUIRE_FALSE(told.empty());
        CHECK(told.back().estimate);
    }
}

TEST_CASE("over a swerve the model's carrier is found by a shorter window or not at all, never far from the truth",
          "[simulation][tones][R54]") {
    Flight flight;
    flight.with_samples = false;
    flight.total_c_n0_dbhz = 24.0;
    const auto doppler = [](double t) { return t < 20.0 ? 0.0 : t < 20.5 ? 2000.0 * (t - 20.0) : 1000.0; };
    flight.doppler_hz = doppler;
    bool fluctuated = false;
    for (const auto& each : hear(flight).model) {
        fluctuated = fluctuated || each.lock != CarrierLock::locked;
        const double at_s = static_cast<double>(each.middle.microseconds) * 1e-6;
        if (each.estimate && std::abs(at_s - 20.25) > 0.7)
            CHECK(each.estimate->residual_hz == Approx(doppler(at_s)).margin(6.0 * each.estimate->sigma_hz + 0.1));
    }
    CHECK(fluctuated);
}

TEST_CASE("of a Doppler that was predicted nothing is left, however fast it changes", "[simulation][tones][R54]") {
    Flight flight;
    flight.until_s = 20.0;
    flight.total_c_n0_dbhz = 26.0;
    flight.doppler_hz = [](double t) { return -400'000.0 + 3000.0 * t; };
    flight.predict_hz = *TimeTable::make({-1.0, 21.0}, {-403'000.0, -337'000.0});
    const auto both = hear(flight);
    for (const auto& told : {both.model, both.samples}) {
        CHECK(told.size() > 8 * 15);
        for (const auto& each : told) {
            REQUIRE(each.estimate);
            // The first eighth of all is at the edge of its window, and less sure than is told.
            const double deviations = &each == &told.front() ? 8.0 : 5.0;
            CHECK(each.estimate->residual_hz == Approx(0.0).margin(deviations * each.estimate->sigma_hz));
            CHECK(each.predict_hz == Approx(flight.doppler_hz(static_cast<double>(each.middle.microseconds) * 1e-6)));
        }
    }
}

TEST_CASE("a copied model of the carrier continues alike", "[simulation][tones]") {
    CarrierModel model{22.0, {}, 3, 1};
    XBandField field;
    field.up = true;
    for (int tick = 0; tick < 500; ++tick) (void)model.hear(field);
    auto copy = model;
    for (int tick = 0; tick < 64; ++tick) {
        const auto one = model.hear(field), other = copy.hear(field);
        REQUIRE(one.has_value() == other.has_value());
        if (one && one->estimate) CHECK(one->estimate->residual_hz == other->estimate->residual_hz);
    }
}

}  // namespace simulation_carrier_model_test
