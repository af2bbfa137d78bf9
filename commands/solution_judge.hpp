// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"

#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// Checks on ground that the parameters of a command come from ground's own navigation. R51
///
/// Flight cannot recognise a wrong position, because it has no other. So the parameters sent must be near one of the
/// solutions that ground has had: in position and velocity at the same epoch, and in the target.
///
/// In      the arguments of a command; ground's solutions, by argument name
/// Out     why they are not ground's, as a sentence; empty where they are, or where ground has no solution
/// Bounds  1 km, 1 m/s; 30 km for the target, 3 km for its radius
/// Memory  some 15 numbers a solution
class SolutionJudge {
  public:
    /// @param solution  may be empty
    explicit SolutionJudge(std::vector<NamedValue> solution);

    /// Adds a newer solution. Commands with an older one may still wait.
    void renew(std::vector<NamedValue> solution);
    /// Empty: ground has none.
    const std::vector<NamedValue>& latest() const { return solutions_.back(); }

    std::string judge(std::span<const NamedValue> arguments) const;

  private:
    std::vector<std::vector<NamedValue>> solutions_;  ///< never empty
};

}  // namespace aeolis::commands
