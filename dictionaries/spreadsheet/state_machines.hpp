// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t transitions_max = 1000;  ///< ours: twenty times the landing's

/// state_machines.csv: which event leads from which state to which. `enumerations`: of the XTCE, whose labels are the
/// states; a null pointer: not known because its own file could not be read, so not checked.
///
/// Rules: a machine is an enumeration; its states are labels of it; one row, without from and event, names the initial
/// state; an event leads from a state to one state; every label can be reached.
std::optional<std::vector<StateMachineTable>>
read_state_machines(std::string_view text, const std::vector<const Type*>* enumerations, Findings& findings);

}  // namespace aeolis::dictionary
