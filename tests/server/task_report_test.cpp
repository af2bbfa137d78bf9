// SPDX-License-Identifier: Apache-2.0
#include "server/venue/task_report.hpp"

#include "flight/kernel/deadlines.hpp"
#include "server/base/json.hpp"
#include "server/rehearsal/landing_report.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/server/running_server.hpp"

#include <google/protobuf/struct.pb.h>

namespace server_task_report_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("in the venue performance a landing reports the times of every task against its budget", "[venue][R8][R36]") {
    Rehearsal rehearsal{test::shipped_scenario("performance"), 1, 0, tests::shipped_dictionary()};
    for (int tick = 0; tick < 64 * 30; ++tick) rehearsal.step();
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

TEST_CASE("a task over its budget, below its stack, or all over a cycle, is not within budgets", "[venue][R8]") {
    MeasuredTimes alone{std::vector<TaskTimes>(1), {}};
    alone.tasks[0].module = flight::ModuleId::sync;
    alone.tasks[0].cycle.add(1000);
    CHECK(within_budgets(alone));
    alone.tasks[0].cycle.add(300'000);  // 0.3 ms against 0.2
    CHECK_FALSE(within_budgets(alone));
    MeasuredTimes deep{std::vector<TaskTimes>(1), {}};
    deep.tasks[0].stack_used_octets = flight::limits_of(deep.tasks[0].module).stack_octets;
    CHECK(within_budgets(deep));
    ++deep.tasks[0].stack_used_octets;
    CHECK_FALSE(within_budgets(deep));
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

TEST_CASE("in the venue performance a landing is the nominal one but for measured times, and its digest is the same "
          "each time",
          "[venue][threads][R36][invariant1]") {
    const auto& dictionary = tests::shipped_dictionary();
    Rehearsal nominal{test::shipped_scenario("nominal_auto"), 1, 0, dictionary};
    Rehearsal measured{test::shipped_scenario("performance"), 1, 0, dictionary};
    Rehearsal again{test::shipped_scenario("performance"), 1, 0, dictionary};
    for (int tick = 0; tick < 64 * 60; ++tick) {
        nominal.step();
        measured.step();
        again.step();
    }
    CHECK(measured.digest() == again.digest());
    // The status of the recorder counts what is recorded, measured times too.
    const auto but_for_counts = [](const Rehearsal& rehearsal) {
        std::vector<std::vector<std::uint8_t>> packets;
        telemetry::PacketStream stream{rehearsal.landing().recording()};
        while (const auto packet = stream.next()) {
            const auto apid = read_primary_header(*packet)->apid;
            namespace packet_of = flight::packet;
            if (apid != packet_of::TaskTimes::apid && apid != packet_of::CommStatus::apid &&
                apid != packet_of::CommStatusB::apid)
                packets.emplace_back(packet->begin(), packet->end());
        }
        return packets;
    };
    CHECK(but_for_counts(nominal).size() > 100);
    CHECK(but_for_counts(measured) == but_for_counts(nominal));
}

TEST_CASE("in the venue GNC alone the digest is of the path: the same for the same seed, another for another",
          "[venue][R36][invariant1]") {
    const auto digest = [](std::uint64_t seed) {
        Rehearsal rehearsal{test::shipped_scenario("gnc_alone"), seed, 0, tests::shipped_dictionary()};
        for (int tick = 0; tick < 64 * 20; ++tick) rehearsal.step();
        return rehearsal.digest();
    };
    CHECK(digest(1) == digest(1));
    CHECK(digest(1) != digest(2));
}

TEST_CASE("a command to a venue without a computer is refused with the reason", "[venue][R36]") {
    Rehearsal rehearsal{test::shipped_scenario("gnc_alone"), 1, 0, tests::shipped_dictionary()};
    v1::CommandRequest request;
    request.set_command("EDL_DO_EDL");
    request.set_request(7);
    const auto reply = rehearsal.submit(request);
    CHECK_FALSE(reply.accepted());
    CHECK(reply.request() == 7);
    CHECK(reply.reason() == "the test venue gnc_alone has no computer");
    CHECK(rehearsal.take_stages().empty());
}

}  // namespace server_task_report_test
