// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace aeolis::telemetry {

/// The variables of a SPICE text kernel: NAME = VALUE or NAME = ( VALUE, … ) between \begindata and \begintext; +=
/// appends. A value is a number (exponents with E or D), a date behind @, or a text in single quotes.
///
/// Dates   become seconds since 2000-01-01T12:00:00 by the calendar, every day 86400 s
/// Faults  "FILE:LINE: …" for the first line that cannot be read
/// Source  [naif-kernel]
class TextKernel {
  public:
    using Value = std::variant<double, std::string>;
    struct Variable {
        unsigned line = 0;  ///< of its last assignment
        std::vector<Value> values;
    };
    static constexpr std::size_t values_max = std::size_t{1} << 22U;  ///< chosen: of all variables together

    /// `file`: its name in error messages.
    static Result<TextKernel> parse(std::string_view text, const std::string& file);

    const Variable* find(const std::string& name) const;
    /// All values of a variable as numbers, at least `least` of them. Fails with the fault, its file and line.
    Result<std::vector<double>> numbers(const std::string& name, std::size_t least) const;
    const std::map<std::string, Variable>& variables() const { return variables_; }
    const std::string& file() const { return file_; }

  private:
    std::string file_;
    std::map<std::string, Variable> variables_;
};

}  // namespace aeolis::telemetry
