// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/thinned_spectrum.hpp"

#include "common/tone_evidence.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

namespace telemetry_thinned_spectrum_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using Samples = std::vector<std::complex<float>>;

namespace {

constexpr double rate_hz = 16384.0;

/// Noise of power 1 a sample, with a line.
Samples noise_with(double line_hz, double c_n0_dbhz, double seconds) {
    std::minstd_rand random{1};
    std::normal_distribution<float> normal{0.0F, std::sqrt(0.5F)};
    const double amplitude = std::sqrt(std::pow(10.0, 0.1 * c_n0_dbhz) / rate_hz);
    Samples all;
    for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
        const double angle = 2.0 * 3.14159265358979 * line_hz * i / rate_hz;
        const auto line = static_cast<std::complex<float>>(std::polar(amplitude, angle));
        all.push_back(line + std::complex<float>{normal(random), normal(random)});
    }
    return all;
}

double loudest_hz(const ThinnedRow& row) {
    const auto loudest = std::ranges::max_element(row.levels) - row.levels.begin();
    return row.first_hz + static_cast<double>(loudest) * row.bin_hz;
}

}  // namespace

TEST_CASE("each second of samples gives a row over the whole band, in which a carrier of 20.5 dB-Hz stands out",
          "[tones][R54]") {
    for (const double line_hz : {-4000.0, -96.0, 0.0, 3776.0, 8000.0}) {
        CAPTURE(line_hz);
        ThinnedSpectrum spectrum{rate_hz, -10.0};
        const Samples samples = noise_with(line_hz, 20.5, 3.5);
        std::vector<ThinnedRow> rows;
        for (std::size_t at = 0; at < samples.size(); at += 1000) {
            spectrum.push(std::span{samples}.subspan(at, std::min<std::size_t>(1000, samples.size() - at)));
            for (auto& row : spectrum.take()) rows.push_back(std::move(row));
        }
        REQUIRE(rows.size() == 3);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const ThinnedRow& row = rows[i];
            CHECK(row.time_s == -9.5 + static_cast<double>(i));
            CHECK(row.bin_hz == 32.0);
            CHECK(row.first_hz == -8192.0);
            REQUIRE(row.levels.size() == thinned_bins);
            CHECK(loudest_hz(row) == line_hz);
            auto levels = row.levels;
            std::ranges::nth_element(levels, levels.begin() + thinned_bins / 2);
            CHECK(std::abs(spectrum_db(levels[thinned_bins / 2])) <= 0.5);
        }
    }
}

TEST_CASE("a second of gap has no row, one with some gap has, and the next rows keep their times", "[tones][R54]") {
    ThinnedSpectrum spectrum{rate_hz, 0.0};
    Samples samples = noise_with(640.0, 30.0, 4.0);
    std::fill(samples.begin() + 16384, samples.begin() + 2 * 16384, std::complex<float>{});
    std::fill(samples.begin() + 2 * 16384, samples.begin() + 2 * 16384 + 5000,
              std::complex<float>{std::numeric_limits<float>::quiet_NaN(), 0.0F});
    spectrum.push(samples);
    const auto rows = spectrum.take();
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].time_s == 0.5);
    CHECK(rows[1].time_s == 2.5);
    CHECK(rows[2].time_s == 3.5);
    for (const auto& row : rows) CHECK(loudest_hz(row) == 640.0);
    CHECK(spectrum.take().empty());
}

}  // namespace telemetry_thinned_spectrum_test
