// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/venue/task_times.hpp"

#include <string>
#include <vector>

namespace aeolis::server {

/// Times of the tasks against their budgets and against the cycle that they share. R8, R36
///
/// table           a line a task, below it a line a message type [us]; the last line is of all tasks together in a
///                 cycle
/// json            an array: task, cycles, least_us, mean_us, p999_us, worst_us, budget_us, unevenness, stack_octets,
///                 stack_bound_octets and messages, an array: message, times, least_us, mean_us, p999_us, worst_us
/// all_tasks_json  of all tasks together in a cycle: cycles, least_us, mean_us, p999_us, worst_us, cycle_us
std::string task_table(const MeasuredTimes& times);
std::string task_json(const MeasuredTimes& times);
std::string all_tasks_json(const MeasuredTimes& times);

/// Each task within its budget in 999 of 1000 cycles and within its stack, and the worst cycle of all tasks together
/// within 1/64 s.
bool within_budgets(const MeasuredTimes& times);

}  // namespace aeolis::server
