// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t owners_max = 1000;  ///< chosen: ten times the rows of the landing

/// Reads owners.csv: one owning module for each device and each label of Decision.
/// A second owner, a missing owner, and an owner of a decision that does not exist are findings. `enumerations` is null
/// when the file with the decisions could not be read: then they are not checked. R5
std::optional<std::vector<OwnerRow>> read_owners(std::string_view text, const std::vector<const Type*>* enumerations,
                                                 Findings& findings);

}  // namespace aeolis::dictionary
