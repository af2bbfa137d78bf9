// SPDX-License-Identifier: Apache-2.0
#include "commands/preconditions.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

namespace commands_preconditions_test {

using namespace aeolis;
using namespace aeolis::commands;
using Verdict = PreconditionReply::Verdict;

namespace {

struct Ground {
    dictionary::Dictionary dictionary = tests::small_dictionary();
    std::vector<LatestValue> latest = std::vector<LatestValue>(dictionary.channels.size());

    void now(std::string_view channel, double value, double age_s = 0.5) {
        latest[dictionary.channel(channel)->id.value] = {value, age_s};
    }
    std::vector<PreconditionReply> checked() const {
        return check(dictionary, *dictionary.command("EDL_DO_EDL"), latest);
    }
};

}  // namespace

TEST_CASE("a precondition holds or fails by the latest value, which is told", "[preconditions][R23]") {
    Ground ground;
    ground.now("parameters_received", 1);
    ground.now("late_cruise", 0);
    const auto replies = ground.checked();
    REQUIRE(replies.size() == 2);
    CHECK(replies[0].verdict == Verdict::holds);
    CHECK(replies[0].text == "parameters_received == 1: is 1");
    CHECK(replies[1].verdict == Verdict::fails);
    CHECK(replies[1].text == "late_cruise == 1: is 0");
    CHECK(replies[1].value == 0.0);
}

TEST_CASE("a value that never came or is old is unknown, not held", "[preconditions]") {
    Ground ground;
    ground.now("late_cruise", 1, stale_after_s + 1.0);
    const auto replies = ground.checked();
    CHECK(replies[0].verdict == Verdict::unknown);
    CHECK(replies[0].text == "parameters_received == 1: not known, no value has come");
    CHECK(replies[1].verdict == Verdict::unknown);
    CHECK(replies[1].text == "late_cruise == 1: not known, the last value, 1, is 31 s old");
}

TEST_CASE("each comparison is the one that it says", "[preconditions]") {
    Ground ground;
    auto& command = ground.dictionary.commands[2];
    const auto channel = ground.dictionary.channel("speed_mps")->id;
    ground.now("speed_mps", 5.0);
    const auto holds = [&](const char* comparison, double bound) {
        command.preconditions = {{channel, comparison, bound, ""}};
        return ground.checked()[0].verdict == Verdict::holds;
    };
    CHECK(holds("==", 5));
    CHECK_FALSE(holds("==", 6));
    CHECK(holds("!=", 6));
    CHECK_FALSE(holds("!=", 5));
    CHECK(holds("<", 6));
    CHECK_FALSE(holds("<", 5));
    CHECK(holds("<=", 5));
    CHECK_FALSE(holds("<=", 4));
    CHECK(holds(">", 4));
    CHECK_FALSE(holds(">", 5));
    CHECK(holds(">=", 5));
    CHECK_FALSE(holds(">=", 6));
}

}  // namespace commands_preconditions_test
