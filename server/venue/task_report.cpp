// SPDX-License-Identifier: Apache-2.0
#include "server/venue/task_report.hpp"

#include "common/time.hpp"
#include "flight/kernel/deadlines.hpp"
#include "server/base/json_object.hpp"
#include "server/venue/flight_names.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string_view>

namespace aeolis::server {
namespace {

constexpr double cycle_us = seconds_per_tick * 1.0e6;

std::string times_text(const Durations& times) {
    return fmt::format("{:>9} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}", times.count(), times.least_us(), times.mean_us(),
                       times.p999_us(), times.worst_us());
}

void add_times(JsonObject& object, std::string_view counted, const Durations& times) {
    object.count(std::string{counted}, times.count())
        .number("least_us", times.least_us())
        .number("mean_us", times.mean_us())
        .number("p999_us", times.p999_us())
        .number("worst_us", times.worst_us());
}

}  // namespace

std::string task_table(const MeasuredTimes& times) {
    std::string text =
        fmt::format("{:<26} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>7} {:>7}\n", "task, its messages", "times",
                    "least us", "mean", "99.9 %", "worst", "budget", "ratio", "uneven", "stack");
    for (const TaskTimes& task : times.tasks) {
        const double budget_us = flight::limits_of(task.module).budget_us;
        text +=
            fmt::format("{:<26} {} {:>8.0f} {:>6.2f} {:>7.1f} {:>7}\n", name_of(task.module), times_text(task.cycle),
                        budget_us, task.cycle.p999_us() / budget_us, unevenness(task), task.stack_used_octets);
        for (std::size_t type = 0; type < task.by_message.size(); ++type)
            if (task.by_message[type].count() > 0)
                text += fmt::format("  {:<24} {}\n", message_names[type], times_text(task.by_message[type]));
    }
    const double worst_us = times.all_tasks.worst_us();
    text += fmt::format("{:<26} {}\n", "all tasks together", times_text(times.all_tasks));
    return text + fmt::format("worst cycle of all tasks together {:.0f} us of {:.0f} us, ratio {:.2f}\n", worst_us,
                              cycle_us, worst_us / cycle_us);
}

std::string task_json(const MeasuredTimes& times) {
    return json_array(times.tasks, [](const TaskTimes& task) {
        std::vector<std::string> by_message;
        for (std::size_t type = 0; type < task.by_message.size(); ++type) {
            if (task.by_message[type].count() == 0) continue;
            JsonObject message;
            message.text("message", std::string{message_names[type]});
            add_times(message, "times", task.by_message[type]);
            by_message.push_back(message.str());
        }
        JsonObject object;
        object.text("task", std::string{name_of(task.module)});
        add_times(object, "cycles", task.cycle);
        return object.number("budget_us", flight::limits_of(task.module).budget_us)
            .number("unevenness", unevenness(task))
            .count("stack_octets", task.stack_used_octets)
            .count("stack_bound_octets", flight::limits_of(task.module).stack_octets)
            .raw("messages", json_array(by_message, [](const std::string& each) { return each; }))
            .str();
    });
}

std::string all_tasks_json(const MeasuredTimes& times) {
    JsonObject object;
    add_times(object, "cycles", times.all_tasks);
    return object.number("cycle_us", cycle_us).str();
}

bool within_budgets(const MeasuredTimes& times) {
    return times.all_tasks.worst_us() <= cycle_us && std::ranges::all_of(times.tasks, [](const TaskTimes& task) {
               const flight::TaskLimits limits = flight::limits_of(task.module);
               return task.cycle.p999_us() <= limits.budget_us && task.stack_used_octets <= limits.stack_octets;
           });
}

}  // namespace aeolis::server
