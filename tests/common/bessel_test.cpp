// SPDX-License-Identifier: Apache-2.0
#include "common/bessel.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace common_bessel_test {

using namespace aeolis;

TEST_CASE("the logarithm of I0 has no seam", "[tones]") {
    CHECK(log_bessel_i0(0.0) == 0.0);
    CHECK(log_bessel_i0(1.0) == Approx(std::log(1.2660658777520084)).epsilon(1e-10));
    CHECK(log_bessel_i0(19.999999) == Approx(log_bessel_i0(20.000001)).margin(3e-6));
    CHECK(log_bessel_i0(2000.0) > 1990.0);
}

}  // namespace common_bessel_test
