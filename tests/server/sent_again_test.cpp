// SPDX-License-Identifier: Apache-2.0
// A command that carries its client's own id is taken once, however often it is sent.

#include "aeolis/v1/run.pb.h"
#include "server/base/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <thread>
#include <vector>

namespace server_sent_again_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

v1::CommandReply sent(const RunningServer& server, const std::string& body, unsigned status = 202) {
    const auto reply = web_request(server.port(), "POST", "/api/v1/runs/latest/commands", body);
    INFO(reply.body);
    CHECK(reply.status == status);
    v1::CommandReply message;
    CHECK(server::from_json(reply.body, message));
    return message;
}

v1::CommandList history(const RunningServer& server) {
    v1::CommandList list;
    REQUIRE(server::from_json(web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body, list));
    return list;
}

/// Waits until the run takes commands.
void until_it_listens(const RunningServer& server) {
    for (int i = 0; i < 3000; ++i) {
        const auto reply =
            web_request(server.port(), "POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP","dry_run":true})");
        if (reply.status == 202) return;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    FAIL("the run takes no commands");
}

}  // namespace

TEST_CASE("a command sent again with its client's id is answered with the fate of the first, and its history shows it",
          "[http][commands][R62]") {
    const RunningServer server{shipped_scenario("nominal"), 10.0};
    until_it_listens(server);
    const std::string no_op = R"({"command":"NO_OP","client_id":"shift-2:1"})";
    const auto first = sent(server, no_op);
    CHECK_FALSE(first.repeated());
    const auto second = sent(server, no_op);
    CHECK(second.repeated());
    CHECK(second.command() == first.command());
    CHECK(second.fate().command() == first.command());
    CHECK_FALSE(second.fate().evidence().empty());
    CHECK(sent(server, R"({"command":"NO_OP","client_id":"shift-2:1","dry_run":true})").repeated());
    CHECK(sent(server, R"({"command":"NO_OP"})").command() == first.command() + 1);

    const auto other = sent(server, R"({"command":"NO_OP","client_id":"shift-2:1","priority":3})", 409);
    CHECK_THAT(other.reason(), Catch::StartsWith("client_id: 'shift-2:1' is command 1 of this run"));
    CHECK_THAT(sent(server, R"({"command":"NO_OP","client_id":"a b"})", 422).reason(),
               Catch::StartsWith("client_id: 1 to 64 of"));

    const auto commands = history(server);
    REQUIRE(commands.commands_size() == 2);
    CHECK(commands.commands(0).client_id() == "shift-2:1");
    CHECK(commands.commands(1).client_id().empty());
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/commands?text=shift").body,
               Catch::Contains("shift-2:1"));
}

TEST_CASE("a refused command leaves its id free", "[http][commands][R62]") {
    const RunningServer server{shipped_scenario("nominal"), 10.0};
    until_it_listens(server);
    CHECK_FALSE(sent(server, R"({"command":"EDL_DO_EDL","client_id":"go"})", 409).accepted());
    CHECK(sent(server, R"({"command":"NO_OP","client_id":"go"})").command() == 1);
}

TEST_CASE("of one command sent by many at once one is taken, also one that changes the timeline",
          "[http][commands][R62]") {
    const RunningServer server{shipped_scenario("nominal"), 10.0};
    until_it_listens(server);
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row = std::ranges::find(timeline, "cruise_stage_separation", &dictionary::TimelineRow::name);
    const std::string change = fmt::format(
        R"({{"command":"EDL_SET_TIMEPOINT_OFFSET","client_id":"c","arguments":[{{"name":"timepoint","value":{}}},)"
        R"({{"name":"desired_offset_s","value":{}}},{{"name":"minimum_offset_s","value":{}}}]}})",
        row - timeline.begin(), 0.046875, 2.0);
    for (const auto& body : {std::string{R"({"command":"NO_OP","client_id":"n"})"}, change}) {
        const auto before = history(server).commands_size();
        std::vector<v1::CommandReply> replies(6);
        std::vector<std::thread> senders;
        for (auto& reply : replies)
            senders.emplace_back([&] {
                const auto answer = web_request(server.port(), "POST", "/api/v1/runs/latest/commands", body);
                static_cast<void>(server::from_json(answer.body, reply));
            });
        for (auto& sender : senders) sender.join();
        for (const auto& reply : replies) {
            INFO(reply.reason());
            CHECK(reply.accepted());
            CHECK(reply.command() == replies.front().command());
        }
        CHECK(std::ranges::count_if(replies, &v1::CommandReply::repeated) == 5);
        CHECK(history(server).commands_size() == before + 1);
    }
}

TEST_CASE("of a command file sent again only what is new goes", "[http][commands][R62]") {
    const RunningServer server{shipped_scenario("nominal"), 10.0};
    until_it_listens(server);
    const auto post = [&](const std::string& body) {
        const auto answer = web_request(server.port(), "POST", "/api/v1/runs/latest/sequences", body);
        INFO(answer.body);
        CHECK(answer.status == 202);
        v1::SequenceReply reply;
        CHECK(server::from_json(answer.body, reply));
        return reply;
    };
    const auto first =
        post(R"({"commands":[{"command":"NO_OP","client_id":"1"},{"command":"NO_OP","client_id":"2"}]})");
    CHECK_FALSE(first.commands(1).repeated());
    const auto again = post(R"({"commands":[{"command":"NO_OP","client_id":"2"},{"command":"NO_OP","client_id":"3"},)"
                            R"({"command":"NO_OP","client_id":"1"}]})");
    REQUIRE(again.commands_size() == 3);
    CHECK(again.commands(0).command() == 2);
    CHECK(again.commands(1).command() == 3);
    CHECK_FALSE(again.commands(1).repeated());
    CHECK(again.commands(2).command() == 1);
    CHECK(history(server).commands_size() == 3);
    const auto twice =
        web_request(server.port(), "POST", "/api/v1/runs/latest/sequences",
                    R"({"commands":[{"command":"NO_OP","client_id":"9"},{"command":"NO_OP","client_id":"9"}]})");
    CHECK(twice.status == 422);
    CHECK_THAT(twice.body, Catch::Contains("'9' is given to two commands"));
}

}  // namespace server_sent_again_test
