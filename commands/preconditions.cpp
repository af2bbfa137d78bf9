// SPDX-License-Identifier: Apache-2.0
#include "commands/preconditions.hpp"

#include "commands/number.hpp"
#include "common/check.hpp"

namespace aeolis::commands {
namespace {

using State = PreconditionState::State;

}  // namespace

const char* name_of(PreconditionState::State state) {
    switch (state) {
    case State::holds: return "holds";
    case State::fails: return "fails";
    case State::unknown: break;
    }
    return "unknown";
}

std::vector<PreconditionState> check(const dictionary::Dictionary& dictionary, const dictionary::Command& command,
                                     std::span<const LatestValue> latest) {
    std::vector<PreconditionState> states;
    states.reserve(command.preconditions.size());
    for (const dictionary::Precondition& condition : command.preconditions) {
        AEOLIS_CHECK(condition.channel.value < dictionary.channels.size());
        const LatestValue now =
            condition.channel.value < latest.size() ? latest[condition.channel.value] : LatestValue{};
        const std::string sentence = dictionary.channels[condition.channel.value].name + " " + condition.comparison +
                                     " " + shortest_text(condition.value);
        PreconditionState state{State::unknown, now.value, {}};
        if (!now.value) {
            state.text = sentence + ": not known, no value has come";
        } else if (now.age_s > stale_after_s) {
            state.text = sentence + ": not known, the last value, " + shortest_text(*now.value) + ", is " +
                         std::to_string(static_cast<long long>(now.age_s)) + " s old";
        } else {
            state.state = condition.holds(*now.value) ? State::holds : State::fails;
            state.text = sentence + ": is " + shortest_text(*now.value);
        }
        states.push_back(std::move(state));
    }
    return states;
}

}  // namespace aeolis::commands
