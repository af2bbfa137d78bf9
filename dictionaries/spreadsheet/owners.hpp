// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t owners_max = 1000;  ///< ours: ten times the landing's

/// What must have an owner; a null pointer: unknown because its own file could not be read, so not checked.
struct OwnerContext {
    const std::vector<TimelineRow>* timeline = nullptr;
    const std::vector<const Type*>* enumerations = nullptr;
};

/// owners.csv: each action of the timeline, each device and each label of the enumeration Decision has one owning
/// module: none has a second, none is missing, and nothing is owned that is not there. R5
std::optional<std::vector<OwnerRow>> read_owners(std::string_view text, const OwnerContext& context,
                                                 Findings& findings);

}  // namespace aeolis::dictionary
