// SPDX-License-Identifier: Apache-2.0
#include "common/mfsk_waveform.hpp"
#include "tests/support/catch.hpp"

namespace common_mfsk_waveform_test {

using namespace aeolis;

TEST_CASE("carrier and first sidebands share the power by the modulation index", "[tones][R31]") {
    const MfskWaveform even{8.4e9, 300.0, 1.0, 10.0, std::numbers::pi / 4.0};
    CHECK(even.carrier_fraction() == Approx(0.5));
    CHECK(even.tone_fraction() == Approx(0.5 * 0.8105695));
    CHECK(even.tone_hz(255) == Approx(555.0));
    CHECK(even.highest_tone_hz() < 3.0 * even.first_tone_hz);
}

}  // namespace common_mfsk_waveform_test
