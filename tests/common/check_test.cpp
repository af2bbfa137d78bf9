// SPDX-License-Identifier: Apache-2.0
#include "common/check.hpp"
#include "tests/support/catch.hpp"

namespace common_check_test {

using namespace aeolis;

TEST_CASE("a failed check names its condition and its line", "[common]") {
    try {
        AEOLIS_CHECK(1 + 1 == 3);
        FAIL("the check did not fail");
    } catch (const CheckFailed& failed) {
        CHECK(std::string{failed.what()} == "1 + 1 == 3");
        CHECK(failed.line() == __LINE__ - 4);
    }
}

}  // namespace common_check_test
