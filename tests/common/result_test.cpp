// SPDX-License-Identifier: Apache-2.0
#include "common/result.hpp"
#include "tests/support/catch.hpp"

namespace common_result_test {

using namespace aeolis;

TEST_CASE("a result holds a value or an error, and asking for the other is a bug", "[common]") {
    const Result<int> good{3};
    const Result<int> bad{Error{"port 8080 is in use"}};
    CHECK(good.value() == 3);
    CHECK_FALSE(bad);
    CHECK(bad.error().message == "port 8080 is in use");
    CHECK_THROWS_AS(bad.value(), CheckFailed);
    CHECK_THROWS_AS(good.error(), CheckFailed);
    CHECK(Result<void>{}.ok());
    CHECK_FALSE(Result<void>{Error{"no"}}.ok());
}

}  // namespace common_result_test
