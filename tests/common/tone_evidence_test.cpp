// SPDX-License-Identifier: Apache-2.0
#include "common/tone_evidence.hpp"
#include "tests/support/catch.hpp"

namespace common_tone_evidence_test {

using namespace aeolis;

TEST_CASE("a level in decibels comes back from its octet to a quarter of a decibel, and ends at the ends",
          "[tones][R31]") {
    for (const double level_db : {-29.8, -3.2, 0.0, 0.2, 25.6, 97.4})
        CHECK(spectrum_db(spectrum_octet(level_db)) == Approx(level_db).margin(0.2501));
    CHECK(spectrum_octet(-80.0) == 0);
    CHECK(spectrum_octet(200.0) == 255);
}

}  // namespace common_tone_evidence_test
