// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/parameters.hpp"

#include <map>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// A parameter at its place in a packet.
struct Placed {
    const Parameter* parameter = nullptr;
    unsigned position_bits = 0;  ///< from the first octet of the packet
    pugi::xml_node element;
};

/// A SequenceContainer with all that its base containers put before it.
struct Layout {
    bool sound = true;  ///< false: something of it has findings; then nothing more is said about it
    bool abstract = false;
    std::vector<Placed> entries;
    unsigned end_bits = 0;
    std::map<std::string, std::int64_t> conditions;  ///< restriction criteria, by name of the parameter
};

/// Lays every container out, base containers first.
class Layouts {
  public:
    Layouts(const Symbols& symbols, const Parameters& parameters, Reporter& report);

    const Layout& of(const Symbol& container) const { return layouts_.at(container.path); }

  private:
    const Layout& lay_out(const Symbol& container, unsigned depth);
    void read_base(const Symbol& container, Layout& layout, unsigned depth);
    void read_conditions(const Symbol& container, pugi::xml_node criteria, Layout& layout);
    void read_condition(const Symbol& container, pugi::xml_node comparison, Layout& layout);
    void read_entry(const Symbol& container, pugi::xml_node entry, Layout& layout);
    /// Where the entry begins, by its LocationInContainerInBits or right after the one before.
    std::optional<unsigned> position_of(pugi::xml_node entry, const Layout& layout);
    void check_overlap(pugi::xml_node entry, const Placed& placed, Layout& layout);

    const Symbols& symbols_;
    const Parameters& parameters_;
    Reporter& report_;
    std::map<std::string, Layout> layouts_;
};

}  // namespace aeolis::dictionary::xtce
