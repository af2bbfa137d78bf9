// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/venue/task_times.hpp"

#include <string>
#include <vector>

namespace aeolis::server {

/// Reports the times of the tasks against their budgets and against the cycle that they share. R8, R36
///
/// table           one line per task and below it one per message type [us]; the last line is all tasks together in a
///                 cycle
/// json            an array: task, cycles, least_us, mean_us, p999_us, worst_us, budget_us, unevenness, stack_octets,
///                 stack_bound_octets and messages, an array: message, times, least_us, mean_us, p999_us, worst_us
/// all_tasks_json  all tasks together in a cycle: cycles, least_us, mean_us, p999_us, worst_us, cycle_us
std::string task_table(const MeasuredTimes& times);
std::string task_json(const MeasuredTimes& times);
std::string all_tasks_json(const MeasuredTimes& times);

/// Whether tasks keep their limits: each its budget in 999 of 1000 cycles and its stack; all tasks together 1/64 s in
/// the worst cycle.
bool within_budgets(const MeasuredTimes& times);

}  // namespace aeolis::server
