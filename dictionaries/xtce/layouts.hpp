// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/parameters.hpp"

#include <map>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

inline constexpr unsigned base_depth_max = 16;  ///< of base containers; chosen: a longer chain can only be a cycle

/// A parameter at its place in a packet.
struct Placed {
    const Parameter* parameter = nullptr;
    unsigned position_bits = 0;  ///< from the first octet of the packet
    pugi::xml_node element;
};

/// A SequenceContainer, including the entries of its base containers.
struct Layout {
    bool sound = true;  ///< false: part of it has findings; nothing more is reported about it
    bool abstract = false;
    std::vector<Placed> entries;
    unsigned end_bits = 0;
    std::map<std::string, std::int64_t> conditions;  ///< restriction criteria, by parameter name
};

/// Layouts of all containers, base containers first.
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
    /// Position of the entry: its LocationInContainerInBits, or directly after the previous entry.
    std::optional<unsigned> position_of(pugi::xml_node entry, const Layout& layout);
    void check_overlap(pugi::xml_node entry, const Placed& placed, Layout& layout);

    const Symbols& symbols_;
    const Parameters& parameters_;
    Reporter& report_;
    std::map<std::string, Layout> layouts_;
};

}  // namespace aeolis::dictionary::xtce
