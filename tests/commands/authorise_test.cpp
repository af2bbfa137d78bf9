// SPDX-License-Identifier: Apache-2.0
#include "commands/authorise.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

namespace commands_authorise_test {

using namespace aeolis;
using namespace aeolis::commands;
using Verdict = PreconditionReply::Verdict;

namespace {

const dictionary::Command& command(std::string_view name) {
    static const auto dictionary = tests::small_dictionary();
    return *dictionary.command(name);
}

}  // namespace

TEST_CASE("a harmless command needs neither arming nor confirmation", "[authorise]") {
    CHECK_FALSE(is_hazardous(command("NO_OP")));
    CHECK(authorise(command("NO_OP"), {}, {}).ok());
}

TEST_CASE("a hazardous command needs arming and its name typed exactly", "[authorise][R44]") {
    const auto& start = command("EDL_DO_EDL");
    CHECK(is_hazardous(start));
    CHECK(authorise(start, {false, "EDL_DO_EDL"}, {}).error().message ==
          "EDL_DO_EDL is hazardous (it cannot be undone): it must be armed first");
    CHECK(authorise(start, {true, ""}, {}).error().message ==
          "EDL_DO_EDL is hazardous (it cannot be undone): its name must be typed to confirm, nothing was typed");
    CHECK_FALSE(authorise(start, {true, "edl_do_edl"}, {}).ok());
    CHECK_FALSE(authorise(start, {true, "EDL_DO_EDL "}, {}).ok());
    CHECK(authorise(start, {true, "EDL_DO_EDL"}, {}).ok());
}

TEST_CASE("a precondition that fails refuses and is told; one that is not known is left to flight",
          "[authorise][R23]") {
    const std::vector<PreconditionReply> replies{{Verdict::holds, 1.0, "a == 1: is 1"},
                                                 {Verdict::fails, 0.0, "b == 1: is 0"},
                                                 {Verdict::unknown, {}, "c == 1: not known, no value has come"},
                                                 {Verdict::fails, 3.0, "d < 2: is 3"}};
    CHECK(authorise(command("NO_OP"), {}, replies).error().message ==
          "NO_OP must not be sent now: b == 1: is 0; d < 2: is 3");
    CHECK(authorise(command("NO_OP"), {}, std::span{replies}.subspan(2, 1)).ok());
}

TEST_CASE("in the shipped dictionary do edl is hazardous and wants parameters in late cruise",
          "[authorise][R23][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto& start = *dictionary.command("EDL_DO_EDL");
    CHECK(is_hazardous(start));
    std::vector<LatestValue> latest(dictionary.channels.size());
    const auto now = [&](const char* channel, double value) {
        latest[dictionary.channel(channel)->id.value] = {value, 0.0};
    };
    const auto allowed = [&] { return authorise(start, {true, "EDL_DO_EDL"}, check(dictionary, start, latest)).ok(); };
    now("parameters_received", 0);
    CHECK_FALSE(allowed());
    now("parameters_received", 1);
    now("late_cruise", 1);
    now("edl_enabled", 0);
    CHECK(allowed());
    now("edl_enabled", 1);
    CHECK_FALSE(allowed());
    now("edl_enabled", 0);
    now("late_cruise", 0);
    CHECK_FALSE(allowed());
    CHECK_FALSE(is_hazardous(*dictionary.command("EDL_SET_PARAMETERS")));
}

}  // namespace commands_authorise_test
