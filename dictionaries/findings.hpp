// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aeolis::dictionary {

/// Collects the findings of one file's rules.
class Findings {
  public:
    Findings(std::string file, std::vector<Finding>& all) : file_(std::move(file)), all_(all) {}

    /// Number of findings so far, including those of other files.
    std::size_t size() const { return all_.size(); }

    void add(unsigned line, std::string message) { all_.push_back({file_, line, std::move(message)}); }

  private:
    std::string file_;
    std::vector<Finding>& all_;
};

inline std::string in_quotes(std::string_view name) {
    return "'" + std::string{name} + "'";
}

}  // namespace aeolis::dictionary
