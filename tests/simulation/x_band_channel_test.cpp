// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_channel.hpp"
#include "tests/support/tone_signal.hpp"

#include <cmath>

namespace simulation_x_band_channel_test {

using namespace aeolis;
using namespace aeolis::simulation;
using aeolis::tests::mfsk;
using aeolis::tests::samples_of;
using aeolis::tests::table;

TEST_CASE("fast normals have mean 0, deviation 1, kurtosis 3, no correlation, and tails", "[tones]") {
    FastNormal noise{1, 0, Stream::x_band_noise};
    constexpr int count = 2'000'000;
    double sum = 0.0, squares = 0.0, fourths = 0.0, products = 0.0, before = 0.0;
    int beyond_3 = 0, beyond_4 = 0;
    for (int i = 0; i < count; ++i) {
        const double x = noise();
        sum += x;
        squares += x * x;
        fourths += x * x * x * x;
        products += x * before;
        before = x;
        beyond_3 += std::abs(x) > 3.0;
        beyond_4 += std::abs(x) > 4.0;
    }
    CHECK(sum / count == Approx(0.0).margin(0.003));
    CHECK(squares / count == Approx(1.0).margin(0.005));
    CHECK(fourths / count == Approx(3.0).margin(0.03));
    CHECK(products / count == Approx(0.0).margin(0.003));
    CHECK(beyond_3 / (0.0026998 * count) == Approx(1.0).margin(0.05));
    CHECK(beyond_4 / (6.334e-5 * count) == Approx(1.0).margin(0.35));
}

TEST_CASE("noise has power 1 a sample and the signal what is asked for, at gain and set", "[tones]") {
    XBandPath path;
    path.rate_hz = 4096.0;
    path.total_c_n0_dbhz = 10.0 * std::log10(4096.0) + 20.0;  // a hundred times the noise
    path.gain_db = table({0.0, 4.9, 5.0, 5.5, 5.6, 10.0}, {0.0, 0.0, 0.0, -20.0, -20.0, -20.0});
    path.set_s = 8.0;
    const auto samples = samples_of(path, {{0.0, 200}}, 10.0);
    const auto power = [&](double from_s, double to_s) {
        double total = 0.0;
        for (auto i = static_cast<std::size_t>(from_s * 4096.0); i < static_cast<std::size_t>(to_s * 4096.0); ++i)
            total += std::norm(samples[i]);
        return total / ((to_s - from_s) * 4096.0);
    };
    CHECK(power(0.0, 4.8) == Approx(1.0 + 100.0).epsilon(0.08));  // the harmonics beyond the band are missing
    CHECK(power(6.0, 7.9) == Approx(2.0).epsilon(0.05));
    CHECK(power(8.1, 10.0) == Approx(1.0).epsilon(0.05));
}

TEST_CASE("carrier and first sidebands have the powers of the budget", "[tones]") {
    XBandPath path;
    path.rate_hz = 8192.0;
    path.total_c_n0_dbhz = 10.0 * std::log10(8192.0) + 30.0;  // amplitude² 1000
    const auto samples = samples_of(path, {{0.0, 100}}, 10.0);
    const auto line_power = [&](double frequency_hz) {
        std::complex<double> sum{};
        for (std::size_t i = 0; i < samples.size(); ++i)
            sum += static_cast<std::complex<double>>(samples[i]) *
                   std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / 8192.0);
        return std::norm(sum / static_cast<double>(samples.size()));
    };
    CHECK(line_power(0.0) == Approx(1000.0 * mfsk.carrier_fraction()).epsilon(0.01));
    CHECK(line_power(400.0) + line_power(-400.0) == Approx(1000.0 * mfsk.tone_fraction()).epsilon(0.01));
    CHECK(line_power(1200.0) + line_power(-1200.0) == Approx(1000.0 * mfsk.tone_fraction() / 9.0).epsilon(0.02));
}

TEST_CASE("samples are the same whatever the portions, and others with another seed", "[tones]") {
    XBandPath path;
    path.doppler_hz = table({0.0, 10.0}, {100.0, -300.0});
    XBandChannel whole{mfsk, path, {{0.5, 3}}, 1, 0}, portions{mfsk, path, {{0.5, 3}}, 1, 0},
        other{mfsk, path, {{0.5, 3}}, 2, 0};
    std::vector<std::complex<float>> a(50000), b(50000), c(50000);
    whole.next(a);
    for (std::size_t at = 0; at < b.size(); at += 625) portions.next(std::span{b}.subspan(at, 625));
    other.next(c);
    CHECK(a == b);
    CHECK(a != c);
}

}  // namespace simulation_x_band_channel_test
