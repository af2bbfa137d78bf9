// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t owners_max = 1000;  ///< chosen: ten times the rows of the landing

/// Everything that must have an owner.
/// A null pointer: its own file could not be read, so it is not checked.
struct OwnerContext {
    const std::vector<TimelineRow>* timeline = nullptr;
    const std::vector<const Type*>* enumerations = nullptr;
};

/// Reads owners.csv: one owning module for each action, each device and each label of Decision.
/// A second owner, a missing owner, and an owner of something that does not exist are findings. R5
std::optional<std::vector<OwnerRow>> read_owners(std::string_view text, const OwnerContext& context,
                                                 Findings& findings);

}  // namespace aeolis::dictionary
