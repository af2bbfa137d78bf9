#include "server/venue/task_report.hpp"

#include "common/time.hpp"
#include "flight/kernel/deadlines.hpp"
#include "server/api/json_object.hpp"
#include "server/venue/flight_names.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string_view>

namespace aeolis::server {
namespace {

constexpr double cycle_us = seconds_per_tick * 1.0e6;

double worst_together_us(const std::vector<TaskTimes>& tasks) {
    double sum_us = 0.0;
    for (const TaskTimes& task : tasks)
        sum_us += task.cycle.worst_us();
    return sum_us;
}

std::string times_text(const Durations& times) {
    return fmt::format("{:>9} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}", times.count(), times.least_us(), times.mean_us(),
                       times.p999_us(), times.worst_us());
}

JsonObject times_json(std::string_view key, std::string_view name, const Durations& times) {
    JsonObject object;
    object.text(std::string{key}, std::string{name})
        .count("times", times.count())
        .number("least_us", times.least_us())
        .number("mean_us", times.mean_us())
        .number("p999_us", times.p999_us())
        .number("worst_us", times.worst_us());
    return object;
}

} // namespace

std::string task_table(const std::vector<TaskTimes>& tasks) {
    std::string text = fmt::format("{:<26} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>7} {:>7}\n", "task, its messages",
                                   "times", "least us", "mean", "99.9 %", "worst", "budget", "ratio", "uneven", "stack");
    for (const TaskTimes& task : tasks) {
        const double budget_us = flight::limits_of(task.module).budget_us;
        text += fmt::format("{:<26} {} {:>8.0f} {:>6.2f} {:>7.1f} {:>7}\n", name_of(task.module), times_text(task.cycle),
                            budget_us, task.cycle.p999_us() / budget_us, unevenness(task), task.stack_used_octets);
        for (std::size_t type = 0; type < task.by_message.size(); ++type)
            if (task.by_message[type].count() > 0)
                text += fmt::format("  {:<24} {}\n", message_names[type], times_text(task.by_message[type]));
    }
    const double together_us = worst_together_us(tasks);
    return text + fmt::format("worst of all tasks together {:.0f} us of a cycle's {:.0f} us, ratio {:.2f}\n", together_us,
                              cycle_us, together_us / cycle_us);
}

std::string task_json(const std::vector<TaskTimes>& tasks) {
    return json_array(tasks, [](const TaskTimes& task) {
        std::vector<std::string> by_message;
        for (std::size_t type = 0; type < task.by_message.size(); ++type)
            if (task.by_message[type].count() > 0)
                by_message.push_back(times_json("message", message_names[type], task.by_message[type]).str());
        return times_json("task", name_of(task.module), task.cycle)
            .number("budget_us", flight::limits_of(task.module).budget_us)
            .number("unevenness", unevenness(task))
            .count("stack_octets", task.stack_used_octets)
            .raw("messages", json_array(by_message, [](const std::string& each) { return each; }))
            .str();
    });
}

bool within_budgets(const std::vector<TaskTimes>& tasks) {
    return worst_together_us(tasks) <= cycle_us && std::ranges::all_of(tasks, [](const TaskTimes& task) {
               return task.cycle.p999_us() <= flight::limits_of(task.module).budget_us;
           });
}

} // namespace aeolis::server
