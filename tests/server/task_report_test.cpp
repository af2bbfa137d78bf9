#include "server/venue/task_report.hpp"

#include "server/api/json.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "tests/server/running_server.hpp"

#include <google/protobuf/struct.pb.h>

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("in the venue performance a landing reports the times of every task against its budget", "[venue][R8][R36]") {
    Rehearsal rehearsal{test::shipped_scenario("performance"), 1, 0, tests::shipped_dictionary()};
    for (int tick = 0; tick < 64 * 30; ++tick)
        rehearsal.step();
    REQUIRE(rehearsal.task_times());
    REQUIRE(rehearsal.task_times()->tasks.size() == flight::module_count);

    google::protobuf::Struct report;
    REQUIRE(from_json(landing_json(rehearsal, 1.0), report));
    CHECK(report.fields().at("test_venue").string_value() == "performance");
    const auto& tasks = report.fields().at("tasks").list_value();
    REQUIRE(tasks.values_size() == static_cast<int>(flight::module_count));
    bool saw_edl = false;
    for (const auto& value : tasks.values()) {
        const auto& task = value.struct_value().fields();
        CHECK(task.at("budget_us").number_value() > 0);
        CHECK(task.at("least_us").number_value() <= task.at("mean_us").number_value());
        CHECK(task.at("mean_us").number_value() <= task.at("worst_us").number_value());
        if (task.at("task").string_value() != "edl") continue;
        saw_edl = true;
        CHECK(task.at("cycles").number_value() >= 64 * 29);
        CHECK(task.at("messages").list_value().values_size() >= 2);
    }
    CHECK(saw_edl);
    const auto& together = report.fields().at("all_tasks").struct_value().fields();
    CHECK(together.at("cycles").number_value() == 64 * 30);
    CHECK(together.at("worst_us").number_value() > 0);
    CHECK_THAT(task_table(*rehearsal.task_times()), Catch::Contains("worst cycle of all tasks together"));
}

TEST_CASE("a task over its budget, or all over a cycle, is not within budgets", "[venue][R8]") {
    MeasuredTimes alone{std::vector<TaskTimes>(1), {}};
    alone.tasks[0].module = flight::ModuleId::sync;
    alone.tasks[0].cycle.add(1000);
    CHECK(within_budgets(alone));
    alone.tasks[0].cycle.add(200'000); // 0.2 ms against 0.1
    CHECK_FALSE(within_budgets(alone));
    // Worst in different cycles: their sum is nobody's.
    MeasuredTimes together{std::vector<TaskTimes>(4), {}};
    for (auto& task : together.tasks) {
        task.module = flight::ModuleId::edl;
        task.cycle.add(4'500'000);
        together.all_tasks.add(4'500'000);
    }
    CHECK(within_budgets(together));
    together.all_tasks.add(16'000'000);
    CHECK_FALSE(within_budgets(together));
}
