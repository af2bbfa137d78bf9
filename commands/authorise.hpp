// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/preconditions.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <span>
#include <string>

namespace aeolis::commands {

/// Whether the command's significance is critical or severe: it needs arming and its name typed.
bool is_hazardous(const dictionary::Command& command);

struct Intent {
    bool armed = false;
    std::string confirmation;  ///< what the controller typed
};

/// Checks whether the command may be released. Fails, with the reason in words, when it is hazardous and not armed or
/// its name was not typed exactly, or when a precondition fails. An unknown precondition does not refuse it: flight
/// checks the same conditions with its own data, and the caller informs the controller. R23
Result<void> authorise(const dictionary::Command& command, const Intent& intent,
                       std::span<const PreconditionReply> preconditions);

}  // namespace aeolis::commands
