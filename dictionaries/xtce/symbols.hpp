// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/document.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::dictionary::xtce {

enum class Kind { parameter_type, argument_type, parameter, container, command, command_container };

/// A named element of a SpaceSystem, and its path.
struct Symbol {
    Kind kind{};
    std::string path;   ///< "/MSL/Events/COMMAND_ACCEPTED"
    std::string scope;  ///< path of its SpaceSystem
    pugi::xml_node element;
};

/// All names of the files. A reference is resolved in its own SpaceSystem, then outwards.
/// "Events/X" and "/MSL/Events/X" lead into other SpaceSystems; "./X" and "../X" are looked for there alone.
class Symbols {
  public:
    enum class Names : std::uint8_t {
        strict,  ///< as XTCE permits: without any of ./:[] and blanks
        any,     ///< also names with these, which other missions' files have
    };
    /// Duplicates within a SpaceSystem are findings. The root SpaceSystems of several files stand side by side; those
    /// with the same name are merged.
    Symbols(const std::vector<const Document*>& documents, Reporter& report, Names names = Names::strict);

    const Symbol* find(Kind kind, const std::string& scope, std::string_view reference) const;
    /// All symbols, in the order of the file.
    const std::vector<Symbol>& all() const { return all_; }

  private:
    void read_space_system(pugi::xml_node system, const std::string& outer, unsigned depth, Reporter& report);
    void read_set(pugi::xml_node set, Kind kind, const std::string& scope, Reporter& report);
    void add(Kind kind, const std::string& scope, pugi::xml_node element, Reporter& report);

    Names names_;
    std::vector<Symbol> all_;
    std::map<std::pair<Kind, std::string>, std::size_t> by_path_;
};

}  // namespace aeolis::dictionary::xtce
