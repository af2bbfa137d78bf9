// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"

#include <array>

// Deadline-monotonic priorities: the module with the shorter deadline runs first. R8
namespace aeolis::flight {

/// Deadline of a module after the tick, and its limits of processor time and stack.
struct TaskLimits {
    double deadline_s = 0.0;       ///< after the tick
    double budget_us = 0.0;        ///< processor time in one cycle
    std::size_t stack_octets = 0;  ///< largest stack used so far
};

/// Limits of each module; our assumption.
/// The rate group shares the cycle of 1/64 s, with deadlines in sync's order. Modules that only feed or follow it have
/// until the next tick; EdlBg and MFSK work at 1 Hz and slower. A stack is about twice what a landing uses.
constexpr TaskLimits limits_of(ModuleId id) {
    constexpr double tick_s = seconds_per_tick;
    constexpr std::size_t kilo = 1024;
    switch (id) {
    case ModuleId::sync: return {0.001, 200.0, 20 * kilo};
    case ModuleId::radar: return {0.002, 200.0, 16 * kilo};
    case ModuleId::imu: return {0.003, 200.0, 16 * kilo};
    case ModuleId::edl: return {0.010, 5000.0, 28 * kilo};
    case ModuleId::pyro: return {0.011, 200.0, 16 * kilo};
    case ModuleId::descent_engines: return {0.012, 200.0, 16 * kilo};
    case ModuleId::thrusters: return {0.013, 200.0, 16 * kilo};
    case ModuleId::power: return {tick_s, 200.0, 16 * kilo};
    case ModuleId::telecom: return {tick_s, 200.0, 16 * kilo};
    case ModuleId::units: return {tick_s, 200.0, 16 * kilo};
    case ModuleId::cruise_attitude: return {tick_s, 200.0, 16 * kilo};
    case ModuleId::system_fault_protection: return {tick_s, 200.0, 16 * kilo};
    case ModuleId::cross_string: return {tick_s, 500.0, 40 * kilo};
    case ModuleId::command_dispatcher: return {tick_s, 500.0, 16 * kilo};
    case ModuleId::edl_bg: return {1.0, 1000.0, 20 * kilo};
    case ModuleId::mfsk: return {1.0, 500.0, 16 * kilo};
    case ModuleId::edl_comm: return {1.0, 2000.0, 16 * kilo};
    }
    return {};
}

/// Whether ModuleId lists the modules in the order of priority: no later one has a shorter deadline.
constexpr bool deadline_monotonic() {
    for (std::size_t id = 1; id < module_count; ++id)
        if (limits_of(static_cast<ModuleId>(id)).deadline_s < limits_of(static_cast<ModuleId>(id - 1)).deadline_s)
            return false;
    return true;
}
static_assert(deadline_monotonic());

constexpr double budgets_together_us() {
    double sum_us = 0.0;
    for (std::size_t id = 0; id < module_count; ++id) sum_us += limits_of(static_cast<ModuleId>(id)).budget_us;
    return sum_us;
}
static_assert(budgets_together_us() <= seconds_per_tick * 1.0e6, "all tasks together fit a cycle");

}  // namespace aeolis::flight
