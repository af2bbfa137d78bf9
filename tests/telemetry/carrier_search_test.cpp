// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/carrier_search.hpp"
#include "tests/support/tone_signal.hpp"

#include <cmath>
#include <limits>

namespace telemetry_carrier_search_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::samples_of;
using aeolis::tests::table;

namespace {

simulation::XBandPath drifting(double frequency_hz, double rate_hzps, double c_n0_dbhz, double rate_hz = 20000.0) {
    simulation::XBandPath path;
    path.rate_hz = rate_hz;
    path.total_c_n0_dbhz = c_n0_dbhz;
    path.doppler_hz = table({0.0, 10.0}, {frequency_hz, frequency_hz + 10.0 * rate_hzps});
    return path;
}

std::vector<CarrierFound> found_in(CarrierSearch& search, std::span<const std::complex<float>> samples) {
    std::vector<CarrierFound> found;
    search.push(samples, found);
    return found;
}

}  // namespace

TEST_CASE("the sum of exponentials passes x as often as the Poisson sum says", "[tones]") {
    CHECK(exceeded_by_noise(1, 3.0) == Approx(std::exp(-3.0)));
    CHECK(exceeded_by_noise(2, 3.0) == Approx(4.0 * std::exp(-3.0)));
    CHECK(exceeded_by_noise(50, 1.0) == Approx(1.0));
    CHECK(exceeded_by_noise(50, 106.0) < 1e-9);
}

TEST_CASE("a carrier of 22 dB-Hz is found anywhere in the band, at any rate to 1200 Hz/s, within a window", "[tones]") {
    for (const auto& [frequency_hz, rate_hzps] :
         {std::pair{0.0, 0.0}, std::pair{8000.0, 1200.0}, std::pair{-9000.0, -1200.0}, std::pair{1234.5, -333.0}}) {
        const auto samples = samples_of(drifting(frequency_hz, rate_hzps, 22.0), {}, 1.2);
        CarrierSearch search{20000.0};
        const auto found = found_in(search, samples);
        REQUIRE_FALSE(found.empty());
        CHECK(found[0].statistic > found[0].threshold);
        const double middle_s = 0.5 * static_cast<double>(found[0].first_sample + found[0].last_sample) / 20000.0;
        CHECK(found[0].frequency_hz == Approx(frequency_hz + rate_hzps * middle_s).margin(15.0));
        CHECK(found[0].rate_hzps == Approx(rate_hzps).margin(50.0));
    }
}

TEST_CASE("what a second does not show, four seconds do", "[tones]") {
    const auto samples = samples_of(drifting(2000.0, -40.0, 16.2), {}, 4.2, 3);
    CarrierSearch search{20000.0};
    const auto found = found_in(search, samples);
    REQUIRE_FALSE(found.empty());
    CHECK(found[0].last_sample - found[0].first_sample == search.longest_window_samples());
    CHECK(found[0].frequency_hz == Approx(2000.0 - 80.0).margin(10.0));
}

TEST_CASE("noise, silence and what is no number hold no carrier", "[tones]") {
    simulation::XBandPath noise = drifting(0.0, 0.0, -100.0);
    CarrierSearch search{20000.0};
    CHECK(found_in(search, samples_of(noise, {}, 40.0)).empty());

    const std::vector<std::complex<float>> silence(100000);
    CarrierSearch in_silence{20000.0};
    CHECK(found_in(in_silence, silence).empty());

    const float none = std::numeric_limits<float>::quiet_NaN(), endless = std::numeric_limits<float>::infinity();
    for (const float part : {none, endless, std::numeric_limits<float>::max()}) {
        const std::vector<std::complex<float>> broken(100000, {part, part});
        CarrierSearch in_broken{20000.0};
        CHECK(found_in(in_broken, broken).empty());
    }
}

}  // namespace telemetry_carrier_search_test
