// SPDX-License-Identifier: Apache-2.0
#include "common/deviation.hpp"

#include "tests/support/catch.hpp"

namespace common_deviation_test {

using namespace aeolis;

TEST_CASE("a deviation is the part that is used of the range on its side, exactly 1 at either end", "[common][R25]") {
    CHECK(deviation(5.0, 5.0, 1.0, 10.0) == 0.0);
    CHECK(deviation(1.0, 5.0, 1.0, 10.0) == 1.0);
    CHECK(deviation(10.0, 5.0, 1.0, 10.0) == 1.0);
    CHECK(deviation(3.0, 5.0, 1.0, 10.0) == 0.5);
    CHECK(deviation(7.5, 5.0, 1.0, 10.0) == 0.5);
    CHECK(deviation(2.5, 2.5, 2.5, 10.0) == 0.0);  // built in at an end: one side has no range
    CHECK(deviation(0.3, 0.1, 0.0, 0.3) == 1.0);
}

}  // namespace common_deviation_test
