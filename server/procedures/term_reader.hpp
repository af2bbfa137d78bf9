// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/procedures/form_reader.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::procedures {

/// Reads what refers to the dictionary: conditions on channels, events and times, and commands with their arguments.
class TermReader : public FormReader {
  public:
    /// Both must outlive this object.
    TermReader(const std::string& file, const dictionary::Dictionary& dictionary)
        : FormReader(file), dictionary_(dictionary) {}

  protected:
    /// A list of conditions; `node` may be null.
    std::vector<Condition> conditions(const YamlNode* node);
    std::optional<PreparedCommand> command(const YamlNode& node);

    const dictionary::Dictionary& dictionary_;
    bool in_steps_ = true;  ///< conditions may count from a step's or procedure's beginning, and those on events say so

  private:
    std::optional<Condition> condition(const YamlNode& node);
    std::optional<Condition> channel_condition(const YamlNode& node);
    std::optional<Condition> event_condition(const YamlNode& node);
    std::optional<Since> since_of(const YamlNode& node);
    bool unit_is_right(const YamlNode& node, const dictionary::Channel& channel);
    std::optional<double> value(const YamlNode& node, const dictionary::Type& type, const std::string& of);
    void arguments(const YamlNode& node, const YamlNode* given, const dictionary::Command& command,
                   PreparedCommand& prepared);
};

}  // namespace aeolis::server::procedures
