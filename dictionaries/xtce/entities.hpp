// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string>

namespace aeolis::dictionary::xtce {

/// Replaces the references to entities that a file's own DTD declares as text: `&deg;`. Lines stay where they are.
/// A reference to one that it does not declare is a finding, and stands as it is written. None, with a finding, when an
/// entity is of markup, of other entities or of another file, or makes a file longer than `entity_octets_max` more.
/// [xml-1.0] 4.1, 4.4
std::optional<std::string> with_entities(std::string text, Findings& findings);
inline constexpr std::size_t entity_octets_max = std::size_t{1} << 20U;  ///< chosen

}  // namespace aeolis::dictionary::xtce
