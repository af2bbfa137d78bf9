// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/doppler_remover.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace telemetry_doppler_remover_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("what is left of a signal whose Doppler is removed stands still, whatever the portions", "[tones][R56]") {
    constexpr double rate_hz = 20000.0, start_s = -7.0;
    std::vector<double> time_s, doppler_hz;
    for (double t = -10.0; t <= 10.0; t += 1.0 / 64.0) {
        time_s.push_back(t);
        doppler_hz.push_back(3000.0 + 900.0 * t + 400.0 * std::sin(t));
    }
    const TimeTable expected = TimeTable::make(time_s, doppler_hz).value();
    std::vector<std::complex<float>> samples(100000);
    double cycles = 0.0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        samples[n] = std::complex<float>{std::polar(1.0, 2.0 * std::numbers::pi * std::fmod(cycles, 1.0))};
        const double t = start_s + (static_cast<double>(n) + 0.5) / rate_hz;
        cycles += (3000.0 + 900.0 * t + 400.0 * std::sin(t)) / rate_hz;
    }
    samples[500] = {};
    auto crumbs = samples;
    DopplerRemover remover{expected, rate_hz, start_s}, other{expected, rate_hz, start_s};
    remover.remove(samples);
    for (std::size_t at = 0; at < crumbs.size(); at += 77)
        other.remove(std::span{crumbs}.subspan(at, std::min<std::size_t>(77, crumbs.size() - at)));
    CHECK(samples == crumbs);
    CHECK(samples[500] == std::complex<float>{});
    for (std::size_t n = 1000; n < samples.size(); n += 1000) {
        const double turned = std::arg(std::complex<double>{samples[n] * std::conj(samples[n - 200])});
        CHECK(std::abs(turned) * rate_hz / 200.0 / (2.0 * std::numbers::pi) < 0.2);  // hertz
    }
}

}  // namespace telemetry_doppler_remover_test
