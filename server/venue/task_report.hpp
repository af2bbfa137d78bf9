#pragma once

#include "server/venue/task_times.hpp"

#include <string>
#include <vector>

namespace aeolis::server {

/// Times of the tasks against their budgets and against the cycle that they share. R8, R36
///
/// table  a line a task, below it a line a message type [us]; the last line is the worst of all together in a cycle
/// json   an array: task, cycles, least_us, mean_us, p999_us, worst_us, budget_us, unevenness, stack_octets, messages
std::string task_table(const std::vector<TaskTimes>& tasks);
std::string task_json(const std::vector<TaskTimes>& tasks);

/// Each task within its budget in 999 of 1000 cycles, and the worst of all together within one cycle.
bool within_budgets(const std::vector<TaskTimes>& tasks);

} // namespace aeolis::server
