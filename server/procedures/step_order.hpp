// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/procedures/procedure.hpp"

#include <cstddef>
#include <vector>

namespace aeolis::server::procedures {

/// Where a step of the main body may lead: its choices, or its next, or the step that follows; after the last one the
/// confirmation.
std::vector<Target> ways_on(const std::vector<Step>& body, std::size_t step);

/// Faults of the order of steps.
struct StepOrder {
    std::vector<std::size_t> unreachable;           ///< steps to which nothing leads, oldest first
    std::vector<std::vector<std::size_t>> circles;  ///< each begins and ends with the same step
};

/// Follows every way through a main body from its first step. Of the circles that share a step one is named.
StepOrder follow(const std::vector<Step>& body);

}  // namespace aeolis::server::procedures
