// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/refusal_budget.hpp"

#include "tests/support/catch.hpp"

namespace server_refusal_budget_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace std::chrono_literals;

TEST_CASE("of one person's refusals so many a minute are noted, and the next one after says how many were not",
          "[audit][bounds]") {
    RefusalBudget budget;
    const RefusalBudget::Clock::time_point begin{};
    for (unsigned i = 0; i < RefusalBudget::each_minute; ++i) CHECK(budget.take("ada", begin + i * 1ms) == 0U);
    for (int i = 0; i < 5; ++i) CHECK_FALSE(budget.take("ada", begin + 59s));
    CHECK(budget.take("carl", begin + 59s) == 0U);  // each has their own
    CHECK(budget.take("ada", begin + 60s) == 5U);
    CHECK(budget.take("ada", begin + 61s) == 0U);
}

}  // namespace server_refusal_budget_test
