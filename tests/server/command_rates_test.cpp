// SPDX-License-Identifier: Apache-2.0
#include "server/api/command_rates.hpp"

#include "tests/support/catch.hpp"

namespace server_command_rates_test {

using namespace std::chrono_literals;
using aeolis::server::CommandRates;

TEST_CASE("a client sends a thousand commands a second for a moment, a hundred for long, and others notice nothing",
          "[http][bounds][R63]") {
    CommandRates rates;
    CommandRates::Clock::time_point now{};
    int sent = 0;
    for (int i = 0; i < 10'000; ++i, now += 1ms) {
        sent += rates.take("greedy", 1, now) ? 0 : 1;
        if (i % 1'000 == 0) CHECK_FALSE(rates.take("other", 100, now));
    }
    CHECK(sent >= static_cast<int>(CommandRates::at_once + 9 * CommandRates::each_second));
    CHECK(sent <= static_cast<int>(CommandRates::at_once + 10 * CommandRates::each_second));
}

TEST_CASE("who is told to wait may send when that time is over", "[http][bounds][R63]") {
    CommandRates rates;
    CommandRates::Clock::time_point now{};
    while (!rates.take("one", 100, now)) {
    }
    const auto wait = rates.take("one", 100, now);
    REQUIRE(wait);
    CHECK(*wait >= 1s);
    CHECK(*wait <= 2s);
    CHECK_FALSE(rates.take("one", 100, now + *wait));
}

}  // namespace server_command_rates_test
