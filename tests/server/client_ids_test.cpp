// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/client_ids.hpp"

#include "tests/support/catch.hpp"

#include <array>

namespace server_client_ids_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

v1::CommandRequest request_of(const std::string& id, const std::string& command = "NO_OP") {
    v1::CommandRequest request;
    request.set_command(command);
    request.set_client_id(id);
    return request;
}

archive::StageRecord stage_of(std::uint64_t number, commands::Stage stage) {
    archive::StageRecord record;
    record.command = number;
    record.name = "NO_OP";
    record.stage = stage;
    record.status = commands::Status::ok;
    return record;
}

}  // namespace

TEST_CASE("a request that repeats one gets its number and how far it has come", "[commands][R62]") {
    ClientIds ids;
    auto request = request_of("shift-2:17");
    CHECK_FALSE(ids.reply_to(request));
    ids.accepted(request, 5);
    ids.note(stage_of(5, commands::Stage::queued));
    ids.note(stage_of(4, commands::Stage::executed));
    ids.note(stage_of(5, commands::Stage::radiated));
    request.set_request(99);  // the number by which this client finds its reply
    request.set_run(3);
    const auto reply = ids.reply_to(request);
    REQUIRE(reply);
    CHECK(reply->accepted());
    CHECK(reply->repeated());
    CHECK(reply->command() == 5);
    CHECK(reply->request() == 99);
    CHECK(reply->fate().stage() == v1::CommandStage::radiated);
    CHECK(reply->fate().status() == v1::CommandStage::ok);
    CHECK(reply->has_fate_us());
}

TEST_CASE("an id of another command, or of another person's, is refused by name", "[commands][R62][R63]") {
    ClientIds ids;
    auto request = request_of("a");
    request.set_controller("Ann");
    ids.accepted(request, 5);
    auto of_bob = request;
    of_bob.set_controller("Bob");
    for (const auto& other : {of_bob, request_of("a", "EDL_DO_EDL")}) {
        const auto reply = ids.reply_to(other);
        REQUIRE(reply);
        CHECK_FALSE(reply->accepted());
        CHECK_THAT(reply->reason(), Catch::StartsWith("client_id: 'a' is command 5 of this run"));
    }
}

TEST_CASE("a request without an id repeats nothing, and an action is none", "[commands][R62]") {
    ClientIds ids;
    ids.accepted(request_of(""), 1);
    CHECK_FALSE(ids.reply_to(request_of("")));
    ids.accepted(request_of("a"), 2);
    auto action = request_of("a");
    action.set_action("cancel");
    CHECK_FALSE(ids.knows(action));
    CHECK_FALSE(check_client_ids(std::array{action}));
}

TEST_CASE("what is no id, or stands twice in a file, is refused", "[commands][R62]") {
    CHECK(check_client_ids(std::array{request_of("A-z_0.9:"), request_of(""), request_of(""), request_of("b")}));
    CHECK_FALSE(check_client_ids(std::array{request_of("a b")}));
    CHECK_FALSE(check_client_ids(std::array{request_of(std::string(65, 'a'))}));
    CHECK_FALSE(check_client_ids(std::array{request_of("é")}));
    const auto twice = check_client_ids(std::array{request_of("a"), request_of("b"), request_of("a")});
    REQUIRE_FALSE(twice);
    CHECK(twice.error().message == "client_id: 'a' is given to two commands");
}

}  // namespace server_client_ids_test
