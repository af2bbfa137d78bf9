// SPDX-License-Identifier: Apache-2.0
// /metrics, and the alert rules and the dashboard that are made of it (setup/monitoring).
#include "server/base/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include <cstdlib>
#include <fstream>
#include <google/protobuf/struct.pb.h>
#include <iterator>
#include <regex>
#include <set>
#include <thread>

namespace server_metrics_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

const std::filesystem::path monitoring = AEOLIS_SOURCE_DIR "/setup/monitoring";

std::string text_of(const std::filesystem::path& file) {
    std::ifstream in{file};
    REQUIRE(in);
    return {std::istreambuf_iterator<char>{in}, {}};
}

std::string metrics(const RunningServer& server) {
    const auto response = web_request(server.port(), "GET", "/metrics");
    REQUIRE(response.status == 200);
    return response.body;
}

/// The metrics once they contain `wanted`; else the last ones.
std::string metrics_with(const RunningServer& server, const std::string& wanted) {
    std::string text;
    for (int i = 0; i < 1000; ++i) {
        text = metrics(server);
        if (text.find(wanted) != std::string::npos) break;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    return text;
}

std::set<std::string> names_in(const std::string& text, const char* pattern) {
    std::set<std::string> names;
    const std::regex name{pattern};
    for (std::sregex_iterator each{text.begin(), text.end(), name}, end; each != end; ++each) names.insert((*each)[1]);
    return names;
}

}  // namespace

TEST_CASE("of a run that is over no gauge is left", "[metrics][http]") {
    RunningServer server;
    CHECK_THAT(metrics(server), Catch::Contains("\naeolis_run_in_progress 0\n") && Catch::Contains("\naeolis_run 0\n"));
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":2})").status ==
            201);
    const auto during = metrics_with(server, "\naeolis_run_attained_pace 2");
    CHECK_THAT(during, Catch::Contains("\naeolis_run_in_progress 1\n") && Catch::Contains("\naeolis_run 1\n") &&
                           Catch::Contains("\naeolis_run_pace 2\n"));
    const std::string held = R"({"command":"NO_OP","hold":true})";
    REQUIRE(web_request(server.port(), "POST", "/api/v1/runs/1/commands", held).status == 202);
    CHECK_THAT(metrics_with(server, "\naeolis_commands_queued 1\n"), Catch::Contains("\naeolis_commands_queued 1\n"));
    REQUIRE(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    const auto after = metrics_with(server, "\naeolis_run_in_progress 0\n");
    for (const char* gauge : {"run_in_progress", "run", "run_pace", "run_attained_pace", "commands_waiting",
                              "commands_put_off", "commands_queued", "commands_at_uplink"})
        CHECK_THAT(after, Catch::Contains(fmt::format("\naeolis_{} 0\n", gauge)));
}

TEST_CASE("the metrics tell build, fault, log, clock, replays, and how long each client's questions waited",
          "[metrics][http]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    REQUIRE_THAT(metrics_with(server, "\naeolis_run 1\n"), Catch::Contains("\naeolis_run 1\n"));
    REQUIRE(web_request(server.port(), "GET", "/api/v1/runs/1/channels?names=altitude_m").status == 200);
    const auto text = metrics_with(server, "aeolis_query_wait_seconds_count{");
    CHECK(std::regex_search(text,
                            std::regex{R"(\naeolis_build_info\{version="[^"]+",schema="1",dictionary="\d+"\} 1\n)"}));
    CHECK_THAT(text, Catch::Contains("\naeolis_archive_fault 0\n") &&
                         Catch::Contains("\naeolis_clock_jumps_total 0\n") &&
                         Catch::Contains("\naeolis_stream_clients_replaying 0\n"));
    CHECK(std::regex_search(text, std::regex{R"(\naeolis_archive_wal_bytes [1-9]\d*\n)"}));
    // Without accounts a client is known by a cookie or an address: neither is shown.
    CHECK(std::regex_search(text, std::regex{R"(\naeolis_query_wait_seconds_count\{client="[0-9a-f]{8}"\} [1-9])"}));
}

TEST_CASE("every metric has one HELP and one TYPE, before its lines", "[metrics][http]") {
    RunningServer server;
    std::istringstream lines{metrics(server)};
    std::set<std::string> begun;
    std::string current;
    for (std::string line; std::getline(lines, line);) {
        INFO(line);
        std::smatch found;
        if (std::regex_match(line, found, std::regex{"# HELP (aeolis_[a-z0-9_]+) .+"})) {
            current = found[1];
            CHECK(begun.insert(current).second);
        } else if (std::regex_match(line, found, std::regex{"# TYPE (aeolis_[a-z0-9_]+) (gauge|counter|summary)"})) {
            CHECK(found[1] == current);
        } else {
            REQUIRE(std::regex_match(line, found, std::regex{R"((aeolis_[a-z0-9_]+)(\{[^}]*\})? [0-9.e+-]+)"}));
            CHECK((found[1] == current || found[1] == current + "_sum" || found[1] == current + "_count"));
        }
    }
}

TEST_CASE("each metric that the alert rules and the dashboard name is one that the server has",
          "[metrics][monitoring]") {
    RunningServer server;
    const auto text = metrics(server);
    auto known = names_in(text, "# HELP (aeolis_[a-z0-9_]+) ");
    for (const auto& summary : names_in(text, "# TYPE (aeolis_[a-z0-9_]+) summary")) {
        known.insert(summary + "_sum");
        known.insert(summary + "_count");
    }
    for (const char* file : {"aeolis-alerts.yml", "aeolis-dashboard.json"}) {
        const auto named = names_in(text_of(monitoring / file), "(aeolis_[a-z0-9_]+)");
        CHECK(named.size() > 10);
        for (const auto& name : named) {
            INFO(file << " names " << name);
            CHECK(known.contains(name));
        }
    }
}

TEST_CASE("the dashboard is JSON whose panels have numbers and places of their own", "[metrics][monitoring]") {
    google::protobuf::Struct dashboard;
    REQUIRE(server::from_json(text_of(monitoring / "aeolis-dashboard.json"), dashboard));
    std::set<double> ids;
    std::set<std::pair<double, double>> places;
    for (const auto& panel : dashboard.fields().at("panels").list_value().values()) {
        const auto& fields = panel.struct_value().fields();
        CHECK(ids.insert(fields.at("id").number_value()).second);
        const auto& place = fields.at("gridPos").struct_value().fields();
        CHECK(places.insert({place.at("x").number_value(), place.at("y").number_value()}).second);
    }
    CHECK(ids.size() > 15);
}

TEST_CASE("promtool finds nothing wrong with the alert rules, and what it would find in broken ones",
          "[metrics][monitoring]") {
    const char* const named = std::getenv("AEOLIS_PROMTOOL");
    const std::string promtool = named != nullptr && *named != '\0' ? named : "promtool";
    if (std::system(fmt::format("command -v '{}' >/dev/null 2>&1", promtool).c_str()) != 0)
        return void(std::printf("SKIPPED: AEOLIS_PROMTOOL names no promtool (./test unpacks one)\n"));
    const auto finds_nothing = [&](const std::filesystem::path& rules) {
        return std::system(fmt::format("'{}' check rules '{}' >/dev/null 2>&1", promtool, rules.string()).c_str()) == 0;
    };
    for (const char* file : {"aeolis-alerts.yml", "aeolis-cluster-alerts.yml"}) {
        INFO(file);
        CHECK(finds_nothing(monitoring / file));
    }
    const TemporaryFolder folder;
    auto broken = text_of(monitoring / "aeolis-alerts.yml");
    const auto expression = broken.find("expr: ");
    REQUIRE(expression != std::string::npos);
    std::ofstream{folder / "broken.yml"} << broken.insert(expression + 6, "sum by (");
    CHECK_FALSE(finds_nothing(folder / "broken.yml"));
}

}  // namespace server_metrics_test
