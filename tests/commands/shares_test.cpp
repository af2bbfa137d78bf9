// SPDX-License-Identifier: Apache-2.0
#include "commands/shares.hpp"

#include "tests/support/catch.hpp"

namespace commands_shares_test {

using aeolis::commands::may_take;

TEST_CASE("whoever takes all that they may leaves as many places free as they hold, however many come",
          "[commands][bounds][R63]") {
    for (const std::size_t places : {1U, 2U, 64U, 4096U}) {
        std::size_t taken = 0;
        for (int asker = 0; asker < 6; ++asker) {
            std::size_t mine = 0;
            while (may_take(mine, taken, places)) {
                ++mine;
                ++taken;
            }
            CHECK(taken <= places);
            CHECK((mine == 0 || mine <= places - taken + 1));
        }
    }
    CHECK_FALSE(may_take(0, 64, 64));
    CHECK_FALSE(may_take(0, 65, 64));
    CHECK(may_take(31, 31, 64));
    CHECK_FALSE(may_take(32, 32, 64));
}

}  // namespace commands_shares_test
