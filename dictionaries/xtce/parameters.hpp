// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/types.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

struct Parameter {
    std::string name;
    std::string path;
    std::optional<Type> type;  ///< none: its type has findings
    std::optional<ChannelId> channel;
    std::string valid_by;  ///< path of the flag that says whether the value is defined; empty: always defined
    pugi::xml_node element;
};

/// Every parameter of the file, by path; and the channels among them, in the order of the file.
struct Parameters {
    std::map<std::string, Parameter> by_path;
    std::vector<Channel> channels;
    std::vector<pugi::xml_node> channel_elements;
};

/// Reads a Comparison of a channel with a number or a label.
/// None, with a finding that begins with `of`, when it is wrong.
/// @param scope  path of the SpaceSystem that contains it
std::optional<Precondition> read_comparison(const Symbols& symbols, const Parameters& parameters,
                                            const std::string& scope, pugi::xml_node comparison, const std::string& of,
                                            Reporter& report);

Parameters read_parameters(const Symbols& symbols, const Types& types, Reporter& report);

}  // namespace aeolis::dictionary::xtce
