// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model_reader.hpp"
#include "dictionaries/xtce/symbols.hpp"

#include <map>
#include <optional>
#include <string>

namespace aeolis::dictionary::xtce {

/// The types of parameters and arguments, read into the model, and each checked once, at its definition, by the rules
/// for our own: whole and real numbers that flight's code can encode, with units, labels that are identifiers, ranges.
class Types {
  public:
    Types(const Symbols& symbols, ModelTypes& model, Reporter& report);

    /// The referenced type; none when the type has findings.
    /// None, with a finding at `element`, when the reference is dangling.
    std::optional<Type> of(Kind kind, const std::string& scope, pugi::xml_node element, const char* attribute,
                           Reporter& report) const;

  private:
    const Symbols& symbols_;
    std::map<std::pair<Kind, std::string>, std::optional<Type>> types_;
};

}  // namespace aeolis::dictionary::xtce
