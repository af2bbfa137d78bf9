// SPDX-License-Identifier: Apache-2.0
#include "commands/authorise.hpp"

namespace aeolis::commands {

bool is_hazardous(const dictionary::Command& command) {
    return command.significance >= dictionary::Significance::critical;
}

Result<void> authorise(const dictionary::Command& command, const Intent& intent,
                       std::span<const PreconditionReply> preconditions) {
    if (is_hazardous(command)) {
        const std::string why = command.reason_for_warning.empty() ? "" : " (" + command.reason_for_warning + ")";
        if (!intent.armed) return Error{command.name + " is hazardous" + why + ": it must be armed first"};
        if (intent.confirmation != command.name)
            return Error{
                command.name + " is hazardous" + why + ": its name must be typed to confirm, " +
                (intent.confirmation.empty() ? "nothing was typed" : "'" + intent.confirmation + "' was typed")};
    }
    std::string failing;
    for (const PreconditionReply& condition : preconditions)
        if (condition.verdict == PreconditionReply::Verdict::fails)
            failing += (failing.empty() ? "" : "; ") + condition.text;
    if (!failing.empty()) return Error{command.name + " must not be sent now: " + failing};
    return {};
}

}  // namespace aeolis::commands
