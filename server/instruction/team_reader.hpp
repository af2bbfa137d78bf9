// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/instruction/inject_plan.hpp"
#include "server/procedures/term_reader.hpp"

#include <google/protobuf/descriptor.h>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server::instruction {

using procedures::YamlNode;

/// Reads what plans and the rubric share: signs, and what a good team does.
class TeamReader : public procedures::TermReader {
  public:
    /// Both must outlive this object.
    TeamReader(const std::string& file, const dictionary::Dictionary& dictionary) : TermReader(file, dictionary) {
        in_steps_ = false;
    }

  protected:
    /// The members `signs` and `team`.
    Handling handling(const YamlNode& node);
    /// A list of words or names.
    std::vector<std::string> names(const YamlNode& node, std::string_view what);
    /// The member `within_s`.
    double within_s(const YamlNode& node);
    /// Whether it is the name of an event or of a tone.
    bool is_report(const std::string& name) const;
    /// The value whose name without `prefix` is the node's, in lower case: DEVICE_PYRO is "pyro".
    std::optional<int> enumerator(const YamlNode& node, std::string_view what,
                                  const google::protobuf::EnumDescriptor& all, std::string_view prefix);

  private:
    Expectation expectation(const YamlNode& node);
    bool is_alarm(const std::string& name) const;
};

}  // namespace aeolis::server::instruction
