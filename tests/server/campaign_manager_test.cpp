// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_manager.hpp"

#include "server/base/json.hpp"
#include "server/campaign/campaign_results.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <chrono>
#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <sched.h>
#include <set>
#include <sys/resource.h>

namespace server_campaign_manager_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::test;

namespace {

template <typename Message>
Message message_of(const WebReply& reply) {
    Message message;
    INFO(reply.status << ": " << reply.body);
    REQUIRE(reply.status < 300);
    REQUIRE(from_json(reply.body, message));
    return message;
}

v1::CampaignReport report(std::uint16_t port, const std::string& campaign) {
    return message_of<v1::CampaignReport>(web_request(port, "GET", "/api/v1/campaigns/" + campaign));
}

/// Waits until it is so, at most twenty minutes: what flies has only what others leave of the processors.
template <typename So>
bool comes(So so) {
    for (int i = 0; i < 24'000; ++i) {
        if (so()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    return false;
}

bool over(const v1::CampaignState& state) {
    return state.state() == "complete" || state.state() == "incomplete";
}

/// Threads of this process that give way to its others.
int idle_threads() {
    int idle = 0;
    constexpr int lowest = 19;
    const bool all_low = getpriority(PRIO_PROCESS, static_cast<id_t>(getpid())) == lowest;  // as under nice(1)
    for (const auto& task : std::filesystem::directory_iterator{"/proc/self/task"}) {
        const int id = std::stoi(task.path().filename().string());
        const bool low = !all_low && getpriority(PRIO_PROCESS, static_cast<id_t>(id)) == lowest;
        if (low || sched_getscheduler(id) == SCHED_IDLE) ++idle;
    }
    return idle;
}

}  // namespace

TEST_CASE("a campaign flies in the server, each case told once in the order in which it came, and comes to what the "
          "program prints",
          "[campaign][http][idle]") {
    RunningServer server;
    const auto port = server.port();
    const auto started =
        web_request(port, "POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":2,"seed":"7"})");
    CHECK(started.status == 202);
    const auto begun = message_of<v1::CampaignState>(started);
    CHECK(begun.campaign() == "campaign-7");
    CHECK(begun.cases() == 2);

    std::vector<v1::CampaignTouchdown> told;
    std::uint32_t after = 0;
    REQUIRE(comes([&] {
        const bool ended = over(report(port, "campaign-7").state());
        const auto target = fmt::format("/api/v1/campaigns/campaign-7/touchdowns?after={}&limit=1", after);
        const auto page = message_of<v1::CampaignTouchdowns>(web_request(port, "GET", target));
        told.insert(told.end(), page.touchdowns().begin(), page.touchdowns().end());
        after = page.next_after();
        return ended && page.touchdowns().empty();
    }));
    std::set<std::uint32_t> cases;
    for (const auto& touchdown : told) {
        CHECK(touchdown.outcome() == "touchdown");
        CHECK(touchdown.has_east_m());
        CHECK(std::abs(touchdown.east_m()) < 30'000.0);
        cases.insert(touchdown.case_());
    }
    CHECK(told.size() == 2);
    CHECK(cases == std::set<std::uint32_t>{1, 2});

    const auto found = report(port, "campaign-7");
    CHECK(found.state().state() == "complete");
    CHECK(found.state().kept() == 2);
    CHECK(found.state().fault().empty());
    CHECK(found.state().seed() == 7);
    REQUIRE(found.outcomes_size() == 1);
    CHECK(found.outcomes(0).count() == 2);
    auto results = campaign::CampaignResults::open(server.archive().parent_path() / "campaign-campaign-7.db", 2);
    REQUIRE(results);
    const auto summary = results->summary();
    REQUIRE(summary);
    CHECK_FALSE(summary->events.empty());
    CHECK(found.miss_m().p50() == summary->miss_m.p50);
    CHECK(found.ellipse().major_m() == summary->ellipse.major_m);
    CHECK(found.ellipse().azimuth_deg() == summary->ellipse.azimuth_deg);
    CHECK(found.parachute_mach().max() == summary->parachute_mach.most);
    CHECK(found.propellant_kg().min() == summary->propellant_kg.least);
    CHECK(found.least_margin().margin_s() == summary->least_margin->margin_s);
    CHECK(found.margins_size() == static_cast<int>(summary->margins.size()));
}

TEST_CASE(
    "a cancelled campaign keeps its cases and goes on when it is started again; meanwhile no other can be started",
    "[campaign][http][idle]") {
    RunningServer server;
    const auto port = server.port();
    const auto start = [&](std::string_view body) { return web_request(port, "POST", "/api/v1/campaigns", body); };
    REQUIRE(comes([] { return idle_threads() == 1; }));  // the one that flies forecasts, once it has begun
    const auto idle_before = idle_threads();
    REQUIRE(start(R"({"scenario":"gnc_alone","cases":10000,"jobs":1})").status == 202);
    REQUIRE(comes([&] { return report(port, "gnc_alone-0").state().kept() >= 2; }));
    CHECK(idle_threads() == idle_before + 1);  // the one that flies; the one that keeps waits for nobody
    const auto flying = report(port, "gnc_alone-0").state();
    CHECK(flying.state() == "flying");
    CHECK(flying.rate_per_s() > 0.0);
    CHECK(flying.remaining_s() > 0.0);
    const auto second = start(R"({"scenario":"campaign","cases":2})");
    CHECK(second.status == 409);
    CHECK_THAT(second.body, Catch::Contains("gnc_alone-0 flies: cancel it first"));
    CHECK(message_of<v1::CampaignList>(web_request(port, "GET", "/api/v1/campaigns")).campaigns_size() == 1);

    const auto reply = web_request(port, "POST", "/api/v1/campaigns/gnc_alone-0/cancel");
    CHECK(reply.status == 202);
    CHECK(message_of<v1::CampaignState>(reply).kept() >= 2);
    REQUIRE(comes([&] { return report(port, "gnc_alone-0").state().state() == "incomplete"; }));
    const auto cancelled = report(port, "gnc_alone-0").state();
    CHECK(idle_threads() == idle_before);
    CHECK(web_request(port, "POST", "/api/v1/campaigns/gnc_alone-0/cancel").status == 409);

    REQUIRE(start(fmt::format(R"({{"scenario":"gnc_alone","cases":{}}})", cancelled.kept() + 2)).status == 202);
    REQUIRE(comes([&] { return report(port, "gnc_alone-0").state().state() == "complete"; }));
    CHECK(report(port, "gnc_alone-0").state().kept() == cancelled.kept() + 2);

    // With the server it ends at once, and what it kept is there after the next start.
    REQUIRE(start(R"({"scenario":"gnc_alone","cases":10000})").status == 202);
    const auto asked = std::clock();  // of the processor, which the server's threads share: the test's own process
    server.restart();
    CHECK(std::clock() - asked < 5 * CLOCKS_PER_SEC);
    const auto list = message_of<v1::CampaignList>(web_request(server.port(), "GET", "/api/v1/campaigns"));
    REQUIRE(list.campaigns_size() == 1);
    CHECK(list.campaigns(0).state() == "incomplete");
    CHECK(list.campaigns(0).kept() >= cancelled.kept() + 2);
    CHECK(list.campaigns(0).cases() == 10'000);
}

TEST_CASE("a campaign that cannot be flown, or does not exist, is refused by name", "[campaign][http]") {
    RunningServer server;
    const auto port = server.port();
    std::ofstream{server.archive().parent_path() / "campaign-other-1.db"}
        << "this is no database, and long enough to be taken for one's first page";
    {
        auto database = archive::sqlite::Database::open((server.archive().parent_path() / "campaign-old-1.db").string(),
                                                        archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        REQUIRE(database->execute("PRAGMA application_id = 0x4165436d; CREATE TABLE campaign (schema_version); INSERT "
                                  "INTO campaign VALUES (3)"));
    }
    struct Row {
        const char* method;
        const char* target;
        const char* body;
        unsigned status;
        const char* says;
    };
    const Row rows[] = {
        {"POST", "/api/v1/campaigns", "{", 400, "StartCampaign"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":-1})", 422, "cases: -1 is not a whole number"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":3,"pace":1})", 400, "pace"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign"})", 422, "cases: 0 is not within 1 … 10000"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":10001})", 422, "10001"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":3,"jobs":10000})", 422, "jobs: 10000"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"campaign","cases":3,"seed":"18446744073709551615"})", 422,
         "seed: 18446744073709551615"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"../../etc/passwd","cases":3})", 422, "none of this name"},
        {"POST", "/api/v1/campaigns", R"({"scenario":"performance","cases":3})", 422, "performance"},
        {"GET", "/api/v1/campaigns/moon-1", "", 404, "moon-1"},
        {"GET", "/api/v1/campaigns/..%2Fa", "", 404, "campaign"},
        {"GET", "/api/v1/campaigns/moon-1/touchdowns", "", 404, "moon-1"},
        {"POST", "/api/v1/campaigns/moon-1/cancel", "", 404, "moon-1"},
        {"GET", "/api/v1/campaigns/old-1", "", 409, "schema_version: 3 there, 2 here"},
        {"GET", "/api/v1/campaigns/old-1/touchdowns", "", 409, "schema_version"},
        {"GET", "/api/v1/campaigns/other-1", "", 409, "campaign-other-1.db"},
        {"GET", "/api/v1/campaigns/old-1/touchdowns?after=x", "", 400, "after"},
        {"GET", "/api/v1/campaigns/old-1/touchdowns?limit=10001", "", 400, "limit"},
        {"GET", "/api/v1/campaigns/old-1/touchdowns?colour=red", "", 400, "colour"},
        {"GET", "/api/v1/campaigns?colour=red", "", 400, "colour"},
        {"GET", "/api/v1/campaigns", "", 200, "\"unreadable\""},
    };
    for (const auto& row : rows) {
        const auto reply = web_request(port, row.method, row.target, row.body);
        INFO(row.method << ' ' << row.target << ' ' << row.body << " -> " << reply.status << ' ' << reply.body);
        CHECK(reply.status == row.status);
        CHECK_THAT(reply.body, Catch::Contains(row.says));
    }
}

}  // namespace server_campaign_manager_test
