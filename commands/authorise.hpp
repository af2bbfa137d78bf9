// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/preconditions.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <span>
#include <string>

namespace aeolis::commands {

/// Significance critical or severe: needs arming and the command's name typed.
bool is_hazardous(const dictionary::Command& command);

struct Intent {
    bool armed = false;
    std::string confirmation;  ///< what the controller typed
};

/// Whether the command may be released. Refused, with the reason in words, when it is hazardous and not armed or its
/// name was not typed exactly, or when a precondition fails. One that ground does not know refuses nothing: flight
/// holds the same conditions and decides by what it knows; the caller tells the controller. R23
Result<void> authorise(const dictionary::Command& command, const Intent& intent,
                       std::span<const PreconditionState> preconditions);

}  // namespace aeolis::commands
