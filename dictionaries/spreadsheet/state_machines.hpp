// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t transitions_max = 1000;  ///< chosen: twenty times the rows of the landing

/// Reads state_machines.csv: the transitions of each state machine.
/// `enumerations`: those of the XTCE file, whose labels are the states. Null: that file could not be read, so states
/// are not checked.
///
/// Rules: a machine is an enumeration; its states are labels of it; one row, without from and event, names the initial
/// state; an event leads from a state to one state; every label can be reached.
std::optional<std::vector<StateMachineTable>>
read_state_machines(std::string_view text, const std::vector<const Type*>* enumerations, Findings& findings);

}  // namespace aeolis::dictionary
