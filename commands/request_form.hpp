// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/fop.hpp"
#include "commands/request.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstddef>
#include <optional>
#include <string>

// What a request must be whatever the run does: told apart from what is not possible now.
namespace aeolis::commands {

inline constexpr std::size_t controller_name_max = 64;  ///< octets; chosen

Result<const dictionary::Command*> command_named(const dictionary::Dictionary& dictionary, const std::string& name);
/// The service of that name; an empty name leaves the choice to the link.
Result<std::optional<Fop::Service>> service_named(const std::string& name);
Result<void> check_controller(const std::string& name);

/// Checks what a request says by itself: known words, a known command, arguments that can be encoded, a name of some
/// length. Fails with one line that names the field and what is allowed. With `from_solution` only the arguments that
/// are given are checked: ground's solution may have the others.
Result<void> check_form(const Request& request, const dictionary::Dictionary& dictionary);
/// The same of an action on a waiting command, and that it names one.
Result<void> check_action(const Request& request);

}  // namespace aeolis::commands
