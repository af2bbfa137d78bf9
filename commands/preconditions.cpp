// SPDX-License-Identifier: Apache-2.0
#include "commands/preconditions.hpp"

#include "commands/number.hpp"
#include "common/check.hpp"

namespace aeolis::commands {
namespace {

using Verdict = PreconditionReply::Verdict;

}  // namespace

const char* name_of(PreconditionReply::Verdict verdict) {
    switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::fails: return "fails";
    case Verdict::unknown: break;
    }
    return "unknown";
}

std::vector<PreconditionReply> check(const dictionary::Dictionary& dictionary, const dictionary::Command& command,
                                     std::span<const LatestValue> latest) {
    std::vector<PreconditionReply> replies;
    replies.reserve(command.preconditions.size());
    for (const dictionary::Precondition& condition : command.preconditions) {
        AEOLIS_CHECK(condition.channel.value < dictionary.channels.size());
        const LatestValue now =
            condition.channel.value < latest.size() ? latest[condition.channel.value] : LatestValue{};
        const std::string sentence = dictionary.channels[condition.channel.value].name + " " + condition.comparison +
                                     " " + shortest_text(condition.value);
        PreconditionReply reply{Verdict::unknown, now.value, {}};
        if (!now.value) {
            reply.text = sentence + ": not known, no value has come";
        } else if (now.age_s > stale_after_s) {
            reply.text = sentence + ": not known, the last value, " + shortest_text(*now.value) + ", is " +
                         std::to_string(static_cast<long long>(now.age_s)) + " s old";
        } else {
            reply.verdict = condition.holds(*now.value) ? Verdict::holds : Verdict::fails;
            reply.text = sentence + ": is " + shortest_text(*now.value);
        }
        replies.push_back(std::move(reply));
    }
    return replies;
}

}  // namespace aeolis::commands
