// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/symbol_error.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace telemetry_symbol_error_test {

using namespace aeolis::telemetry;

TEST_CASE("two tones err by e^(-E/2)/2, as the closed form says", "[tones]") {
    for (const double energy : {0.5, 2.0, 8.0, 20.0})
        CHECK(symbol_error(energy, 2) == Approx(0.5 * std::exp(-0.5 * energy)).epsilon(1e-6));
}

// P = sum over n = 1 … M−1 of (−1)^(n+1) C(M−1, n)/(n+1) e^(−n E/(n+1))
TEST_CASE("few tones err as the alternating sum says", "[tones]") {
    for (const int tones : {4, 8, 16})
        for (const double energy : {1.0, 5.0, 12.0}) {
            double sum = 0.0, choose = 1.0;
            for (int n = 1; n < tones; ++n) {
                choose *= static_cast<double>(tones - n) / n;
                sum += (n % 2 == 1 ? 1.0 : -1.0) * choose / (n + 1) * std::exp(-n * energy / (n + 1));
            }
            CHECK(symbol_error(energy, tones) == Approx(sum).epsilon(1e-6));
        }
}

TEST_CASE("256 tones of 10 s need 2.36, 3.53, 4.41 and 5.11 dB-Hz for 1e-2 to 1e-5", "[tones][R31]") {
    const double needed_dbhz[]{2.36, 3.53, 4.41, 5.11};
    for (int i = 0; i < 4; ++i)
        CHECK(10.0 * std::log10(energy_for_symbol_error(std::pow(10.0, -2.0 - i), 256) / 10.0) ==
              Approx(needed_dbhz[i]).margin(0.005));
    CHECK(symbol_error(0.0, 256) == Approx(255.0 / 256.0).epsilon(1e-4));
}

}  // namespace telemetry_symbol_error_test
