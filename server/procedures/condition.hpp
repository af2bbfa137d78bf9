// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/procedures/procedure.hpp"

#include <string>

// Conditions and values in words.
namespace aeolis::server::procedures {

/// A value with its unit, every digit of it: "4987.25 m", "edl_main", "true".
std::string exact_text(const dictionary::Type& type, double value);

/// "altitude_m < 5000 m for 3 s", "EDL_BEGUN received since the step began", "from E−47:00 sent".
std::string text_of(const Condition& condition, const dictionary::Dictionary& dictionary);

/// "SECOND_CHANCE_ENABLE enabled=yes", with what is to be filled.
std::string text_of(const PreparedCommand& command, const dictionary::Dictionary& dictionary);

/// "step poll", "the confirmation", "the end, not confirmed".
std::string text_of(const Target& target, const std::vector<Step>& body);

}  // namespace aeolis::server::procedures
