// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/stream.pb.h"
#include "server/access/account_file.hpp"
#include "server/archive/reader.hpp"
#include "server/base/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <thread>

namespace server_authority_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

/// A server whose accounts are one of each role.
struct Guarded {
    static constexpr const char* password = "a password of my own";
    RunningServer server{RunningServer::WithAccounts{}};
    std::map<std::string, Headers> as;  ///< headers by role; "nobody": none

    Guarded() {
        as["nobody"];
        take_over("administrator", server.first_password());
        for (const char* role : {"observer", "controller", "director", "instructor"}) {
            const auto body =
                std::string{R"({"user":")"} + role + R"(","role":")" + role + R"(","password":"given by another"})";
            REQUIRE(ask("administrator", "POST", "/api/v1/users", body).status == 201);
            take_over(role, "given by another");
        }
    }
    /// Logs in and chooses a password.
    void take_over(const std::string& user, const std::string& given) {
        as[user] = log_in(user, given);
        const auto body = std::string{R"({"password":")"} + password + R"(","current_password":")" + given + "\"}";
        REQUIRE(ask(user, "PATCH", "/api/v1/users/" + user, body).status == 200);
    }
    Headers log_in(const std::string& user, const std::string& given) const {
        const auto reply = web_request(server.port(), "POST", "/api/v1/session",
                                       R"({"user":")" + user + R"(","password":")" + given + "\"}");
        REQUIRE(reply.status == 201);
        CHECK_THAT(reply.set_cookie, Catch::Contains("HttpOnly") && Catch::Contains("SameSite=Strict"));
        return {{"Cookie", reply.set_cookie.substr(0, reply.set_cookie.find(';'))}};
    }
    WebReply ask(const std::string& role, std::string_view method, std::string_view target,
                 std::string_view body = {}) {
        return web_request(server.port(), method, target, body, as.at(role));
    }
};

/// What the outcome is for a role that has the right; any else gets 401 (nobody) or 403.
struct Row {
    const char* method;
    const char* route;  ///< as in Api::routes()
    const char* least;  ///< the role from which on; "nobody": open
    const char* target;
    const char* body;
    unsigned status;
};
const Row rows[] = {
    {"GET", "/api/v1/session", "nobody", "/api/v1/session", "", 200},
    {"POST", "/api/v1/session", "nobody", "/api/v1/session", "{", 400},
    {"DELETE", "/api/v1/session", "nobody", "/api/v1/session", "", 204},
    {"GET", "/api/v1/users", "administrator", "/api/v1/users", "", 200},
    {"POST", "/api/v1/users", "administrator", "/api/v1/users", "{", 400},
    {"PATCH", "/api/v1/users/{user}", "administrator", "/api/v1/users/someone", R"({"role":"observer"})", 409},
    {"DELETE", "/api/v1/users/{user}", "administrator", "/api/v1/users/someone", "", 409},
    {"GET", "/api/v1/tokens", "administrator", "/api/v1/tokens", "", 200},
    {"POST", "/api/v1/tokens", "administrator", "/api/v1/tokens", "{", 400},
    {"DELETE", "/api/v1/tokens/{name}", "administrator", "/api/v1/tokens/none", "", 409},
    {"DELETE", "/api/v1/runs/{run}", "director", "/api/v1/runs/9", "", 404},
    {"GET", "/api/v1/audit", "administrator", "/api/v1/audit?limit=1", "", 200},
    {"GET", "/api/v1/runs", "observer", "/api/v1/runs", "", 200},
    {"POST", "/api/v1/runs/{run}/commands", "controller", "/api/v1/runs/latest/commands", R"({"command":"NO_OP"})",
     409},
    {"POST", "/api/v1/runs/{run}/sequences", "controller", "/api/v1/runs/latest/sequences",
     R"({"commands":[{"command":"NO_OP"}]})", 409},
    {"POST", "/api/v1/runs/{run}/alarms", "controller", "/api/v1/runs/latest/alarms", "{", 400},
    {"POST", "/api/v1/runs/{run}/notes", "controller", "/api/v1/runs/latest/notes", "{", 400},
    {"GET", "/api/v1/runs/{run}", "observer", "/api/v1/runs/latest", "", 404},
    {"GET", "/api/v1/runs/{run}/prediction", "observer", "/api/v1/runs/latest/prediction", "", 404},
    {"GET", "/api/v1/runs/{run}/samples", "observer", "/api/v1/runs/latest/samples", "", 404},
    {"GET", "/api/v1/runs/{run}/raw", "observer", "/api/v1/runs/latest/raw", "", 404},
    {"GET", "/api/v1/runs/{run}/rows", "instructor", "/api/v1/runs/latest/rows", "", 404},
    {"GET", "/api/v1/runs/{run}/forecasts", "observer", "/api/v1/runs/latest/forecasts", "", 404},
    {"POST", "/api/v1/runs/{run}/forecasts", "controller", "/api/v1/runs/latest/forecasts", "{", 400},
    {"GET", "/api/v1/runs/{run}/forecasts/{forecast}", "observer", "/api/v1/runs/latest/forecasts/1", "", 404},
    {"POST", "/api/v1/runs/{run}/forecasts/{forecast}/cancel", "controller", "/api/v1/runs/latest/forecasts/1/cancel",
     "", 404},
    {"POST", "/api/v1/runs/{run}/procedures", "controller", "/api/v1/runs/latest/procedures", "{", 400},
    {"GET", "/api/v1/runs/{run}/procedures/{number}/acts", "observer", "/api/v1/runs/latest/procedures/1/acts", "",
     404},
    {"POST", "/api/v1/runs/{run}/procedures/{number}/acts", "controller", "/api/v1/runs/latest/procedures/1/acts", "{",
     400},
    {"POST", "/api/v1/runs/{run}/positions", "controller", "/api/v1/runs/latest/positions", "{", 400},
    {"GET", "/api/v1/runs/{run}/{question}", "observer", "/api/v1/runs/latest/events", "", 404},
    {"GET", "/api/v1/layouts", "observer", "/api/v1/layouts", "", 200},
    {"PUT", "/api/v1/layouts/{layout}", "observer", "/api/v1/layouts/mine", "{", 400},
    {"DELETE", "/api/v1/layouts/{layout}", "observer", "/api/v1/layouts/none", "", 404},
    {"GET", "/api/v1/scenarios", "observer", "/api/v1/scenarios", "", 200},
    {"GET", "/api/v1/plans", "instructor", "/api/v1/plans", "", 200},
    {"GET", "/api/v1/procedures", "observer", "/api/v1/procedures", "", 200},
    {"GET", "/api/v1/procedures/{procedure}", "observer", "/api/v1/procedures/none", "", 404},
    {"GET", "/api/v1/dictionary", "observer", "/api/v1/dictionary", "", 200},
    {"GET", "/api/v1/openapi.yaml", "nobody", "/api/v1/openapi.yaml", "", 200},
    {"GET", "/api/v1/schema", "nobody", "/api/v1/schema", "", 200},
    {"GET", "/api/v1/schema/{file}", "nobody", "/api/v1/schema/run.proto", "", 200},
    {"GET", "/api/v1/rehearsals", "observer", "/api/v1/rehearsals", "", 200},
    {"POST", "/api/v1/rehearsals", "director", "/api/v1/rehearsals", "{", 400},
    {"GET", "/api/v1/rehearsals/current", "observer", "/api/v1/rehearsals/current", "", 404},
    {"POST", "/api/v1/rehearsals/current", "director", "/api/v1/rehearsals/current", R"({"pause":true})", 409},
    {"PATCH", "/api/v1/rehearsals/current", "director", "/api/v1/rehearsals/current", R"({"pause":true})", 409},
    {"GET", "/api/v1/campaigns", "observer", "/api/v1/campaigns", "", 200},
    {"POST", "/api/v1/campaigns", "director", "/api/v1/campaigns", R"({"scenario":"campaign","cases":0})", 422},
    {"GET", "/api/v1/campaigns/{campaign}", "observer", "/api/v1/campaigns/none", "", 404},
    {"GET", "/api/v1/campaigns/{campaign}/touchdowns", "observer", "/api/v1/campaigns/none/touchdowns", "", 404},
    {"POST", "/api/v1/campaigns/{campaign}/cancel", "director", "/api/v1/campaigns/none/cancel", "", 404},
    {"GET", "/api/v1/stream", "observer", "/api/v1/stream", "", 426},
    {"GET", "/healthz", "nobody", "/healthz", "", 200},
    {"GET", "/metrics", "observer", "/metrics", "", 200},
};
const char* const ladder[] = {"nobody", "observer", "controller", "director", "instructor", "administrator"};

}  // namespace

TEST_CASE("every route has its row in the table of authority, and its description", "[access][http]") {
    std::ifstream in{AEOLIS_SOURCE_DIR "/server/api/openapi.yaml"};
    const std::string openapi{std::istreambuf_iterator<char>{in}, {}};
    std::set<std::string> served, tabled;
    for (const auto& route : server::Api::routes()) {
        served.insert(std::string{route.method} + ' ' + std::string{route.path});
        INFO(route.method << ' ' << route.path);
        if (route.path.find("{question}") == std::string_view::npos) {  // each of those has its own path, below
            const auto path = openapi.find("\n  " + std::string{route.path} + ":\n");
            REQUIRE(path != std::string::npos);
            auto end = openapi.find("\n  /", path + 4);
            std::string method{route.method};
            for (char& letter : method) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
            CHECK(openapi.substr(path, end - path).find("\n    " + method + ":\n") != std::string::npos);
        }
    }
    for (const auto& row : rows) tabled.insert(std::string{row.method} + ' ' + row.route);
    CHECK(served == tabled);
}

TEST_CASE("each role gets what its rights give on every route, and nothing more", "[access][http]") {
    Guarded guarded;
    for (const auto& row : rows) {
        if (std::string_view{row.route} == "/api/v1/session" && std::string_view{row.method} == "DELETE")
            continue;  // it would end the log-ins
        bool allowed = false;
        for (const char* role : ladder) {
            allowed = allowed || std::string_view{row.least} == role;
            const unsigned wanted = allowed ? row.status : std::string_view{role} == "nobody" ? 401 : 403;
            const auto reply = guarded.ask(role, row.method, row.target, row.body);
            INFO(role << ": " << row.method << ' ' << row.target << " -> " << reply.body.substr(0, 300));
            CHECK(reply.status == wanted);
            CHECK_THAT(reply.security_policy, Catch::Contains("script-src 'self'"));
        }
    }
}

namespace {

struct Message {
    const char* json;
    const char* least;
    const char* says;  ///< what the rest of the server answers once the right is there
};
const Message messages[] = {
    {R"({"command":{"command":"NO_OP","request":7}})", "controller", "no run goes on"},
    {R"({"command":{"command":"EDL_DO_EDL","armed":true,"confirmation":"EDL_DO_EDL"}})", "director", "no run goes on"},
    {R"({"subscribe":{}})", "observer", "welcome"},
    {R"({"control":{"start":{"scenario":"none of ours"}}})", "director", "none of ours"},
    {R"({"control":{"pause":true}})", "director", "no rehearsal goes on"},
    {R"({"control":{"jump":"E-0:47:00"}})", "director", "no rehearsal goes on"},
    {R"({"control":{"pace":2}})", "director", "no rehearsal goes on"},
    {R"({"control":{"stop":true}})", "director", "no rehearsal goes on"},
    {R"({"control":{"inject":{"computer_reset":true}}})", "instructor", "no rehearsal goes on"},
    {R"({"control":{"note":{"text":"seen"}}})", "instructor", "no rehearsal goes on"},
    {R"({"control":{"plan":{"inject":"line_down"}}})", "instructor", "no rehearsal goes on"},
    {R"({"command":{"action":"hold","number":1}})", "director", "no run goes on"},
    {R"({"command":{"action":"cancel","number":1}})", "director", "no run goes on"},
    {R"({"command":{"action":"release","number":1}})", "director", "no run goes on"},
    {R"({"command":{"action":"approve","number":1}})", "director", "no run goes on"},
};

/// "command", or of what a rehearsal is told "control.pause".
std::string kind_of(const v1::ClientMessage& message) {
    const auto* descriptor = v1::ClientMessage::descriptor();
    std::string kind = descriptor->FindFieldByNumber(message.message_case())->name();
    if (message.has_control())
        kind += '.' + v1::RehearsalControl::descriptor()->FindFieldByNumber(message.control().action_case())->name();
    return kind;
}

}  // namespace

TEST_CASE("everything that a client of the stream can say has its row in the table of authority", "[access][stream]") {
    std::set<std::string> sayable, tabled;
    const auto* client = v1::ClientMessage::descriptor();
    for (int i = 0; i < client->field_count(); ++i)
        if (const std::string name = client->field(i)->name(); name != "control") sayable.insert(name);
    const auto* actions = v1::RehearsalControl::descriptor()->FindOneofByName("action");
    for (int i = 0; i < actions->field_count(); ++i) sayable.insert("control." + actions->field(i)->name());
    for (const auto& message : messages) {
        v1::ClientMessage parsed;
        REQUIRE(server::from_json(message.json, parsed));
        tabled.insert(kind_of(parsed));
    }
    CHECK(sayable == tabled);
}

TEST_CASE("each role may send over the stream what it may send by HTTP", "[access][stream]") {
    Guarded guarded;
    CHECK(StreamClient{guarded.server.port(), "aeolis.v1.json"}.status() == 401);
    for (const auto& message : messages) {
        bool allowed = false;
        for (const char* role : ladder) {
            allowed = allowed || std::string_view{message.least} == role;
            if (std::string_view{role} == "nobody") continue;
            StreamClient client{guarded.server.port(), "aeolis.v1.json", guarded.as.at(role)};
            REQUIRE(client.open());
            client.send(message.json, false);
            const auto reply = client.receive();
            INFO(role << ": " << message.json);
            REQUIRE(reply);
            CHECK_THAT(*reply, Catch::Contains(allowed ? message.says : "needs"));
        }
    }
}

TEST_CASE("a wish for an account that makes no sense is 422 and named; what is not possible now is 409",
          "[access][http][bounds][R62]") {
    Guarded guarded;
    struct Wish {
        const char* method;
        const char* target;
        const char* body;
        unsigned status;
        const char* says;
    };
    const Wish wishes[] = {
        {"POST", "/api/v1/users", R"({"user":"nina","role":"nix","password":"given by another"})", 422,
         "role: 'nix' is none of observer, controller"},
        {"POST", "/api/v1/users", R"({"user":"Nina!","role":"observer","password":"given by another"})", 422,
         "user: a name has 1 to"},
        {"POST", "/api/v1/users", R"({"user":"nina","role":"observer","password":"short"})", 422, "password"},
        {"POST", "/api/v1/users", R"({"user":"observer","role":"observer","password":"given by another"})", 409,
         "there is a user 'observer' already"},
        {"PATCH", "/api/v1/users/observer", R"({"role":"nix"})", 422, "role: 'nix' is none of"},
        {"PATCH", "/api/v1/users/observer", "{}", 422, "the change says nothing: role, password"},
        {"PATCH", "/api/v1/users/observer", R"({"commands":["NO_OP"],"all_commands":true})", 422, "one of them"},
        {"PATCH", "/api/v1/users/observer", R"({"password":"short"})", 422, "password"},
        {"PATCH", "/api/v1/users/observer", R"({"all_commands":"perhaps"})", 422, "all_commands: "},
        {"PATCH", "/api/v1/users/someone", R"({"role":"observer"})", 409, "there is no user 'someone'"},
        {"PATCH", "/api/v1/users/administrator", R"({"role":"observer"})", 409, "nobody changes their own"},
        {"POST", "/api/v1/tokens", R"({"name":"robot","role":"nix"})", 422, "role: 'nix' is none of"},
        {"POST", "/api/v1/tokens", R"({"name":"my robot","role":"observer"})", 422, "name: a name has 1 to"},
        {"POST", "/api/v1/tokens", R"({"name":"robot","role":"observer","days":4000})", 422,
         "days: 4000 is more than 3650"},
        {"POST", "/api/v1/tokens", R"({"name":"robot","role":"observer","days":-1})", 422,
         "days: -1 is not a whole number"},
        {"POST", "/api/v1/tokens", R"({"name":"robot","role":"observer","days":0.5})", 422,
         "days: 0.5 is not a whole number"},
        {"POST", "/api/v1/tokens", R"({"name":"robot","role":"observer","owner":"someone"})", 409,
         "owner: there is no user 'someone'"},
    };
    for (const auto& wish : wishes) {
        const auto reply = guarded.ask("administrator", wish.method, wish.target, wish.body);
        INFO(wish.method << ' ' << wish.target << ' ' << wish.body << " -> " << reply.body);
        CHECK(reply.status == wish.status);
        CHECK_THAT(reply.body, Catch::Contains(wish.says));
    }
    CHECK(guarded.ask("administrator", "GET", "/api/v1/tokens").body.find("robot") == std::string::npos);
}

TEST_CASE("a hazardous command by HTTP needs a director, and an account's own list binds it", "[access][http]") {
    Guarded guarded;
    REQUIRE(guarded
                .ask("administrator", "POST", "/api/v1/users",
                     R"({"user":"nina","role":"director","password":"given by another","commands":["NO_OP"]})")
                .status == 201);
    guarded.take_over("nina", "given by another");
    const auto send = [&](const char* role, const char* body) {
        return guarded.ask(role, "POST", "/api/v1/runs/latest/commands", body);
    };
    const char* const landing = R"({"command":"EDL_DO_EDL","armed":true,"confirmation":"EDL_DO_EDL"})";
    CHECK(send("controller", landing).status == 403);
    CHECK_THAT(send("controller", landing).body, Catch::Contains("EDL_DO_EDL is hazardous: it needs a director"));
    CHECK(send("director", landing).status == 409);  // no run goes on
    const auto file = std::string{R"({"commands":[{"command":"NO_OP"},)"} + landing + "]}";
    CHECK_THAT(guarded.ask("controller", "POST", "/api/v1/runs/latest/sequences", file).body,
               Catch::Contains("commands[1]: EDL_DO_EDL is hazardous"));
    CHECK_THAT(send("nina", landing).body, Catch::Contains("not among the commands"));
    CHECK_THAT(send("nina", R"({"action":"release","number":1})").body, Catch::Contains("acts on no others"));
    const auto token =
        guarded.ask("administrator", "POST", "/api/v1/tokens", R"({"name":"robot","role":"director"})").body;
    const auto at = token.find(R"("token":")") + 9;
    guarded.as["robot"] = {{"Authorization", "Bearer " + token.substr(at, 43)}};
    CHECK_THAT(send("robot", R"({"action":"approve","number":1})").body, Catch::Contains("token robot is none"));
    CHECK(send("nina", R"({"command":"NO_OP"})").status == 409);
    CHECK(guarded.ask("administrator", "PATCH", "/api/v1/users/nina", R"({"commands":["NO_SUCH"]})").status == 422);
    CHECK(guarded.ask("administrator", "PATCH", "/api/v1/users/nina", R"({"all_commands":true})").status == 200);
    CHECK(send("nina", landing).status == 409);  // only that no run goes on
    const auto bound =
        guarded
            .ask("administrator", "POST", "/api/v1/tokens", R"({"name":"ping","role":"director","commands":["NO_OP"]})")
            .body;
    guarded.as["ping"] = {{"Authorization", "Bearer " + bound.substr(bound.find(R"("token":")") + 9, 43)}};
    CHECK_THAT(send("ping", landing).body, Catch::Contains("token ping may not send EDL_DO_EDL"));
    CHECK(send("ping", R"({"command":"NO_OP"})").status == 409);
    CHECK(guarded
              .ask("administrator", "POST", "/api/v1/users",
                   R"({"user":"otto","role":"director","password":"given by another","commands":["NO_SUCH"]})")
              .status == 422);
}

namespace {

/// What is asked about a command that waits: 1 is NO_OP, 2 is EDL_DO_EDL, 77 none.
struct OfTheQueue {
    const char* who;
    const char* action;
    int number;
    const char* refusal;  ///< for want of a right; empty: they may
};
const char* const hazardous = "EDL_DO_EDL is hazardous: it needs a director, and carl is controller";
const char* const not_listed = "nina may not send EDL_DO_EDL: it is not among the commands of this account";
const OfTheQueue of_the_queue[] = {
    {"observer", "hold", 1, "right to command"},
    {"observer", "cancel", 2, "right to command"},
    {"carl", "hold", 2, hazardous},
    {"carl", "release", 2, hazardous},
    {"carl", "approve", 2, hazardous},
    {"carl", "cancel", 2, hazardous},
    {"nina", "hold", 2, not_listed},
    {"nina", "release", 2, not_listed},
    {"nina", "approve", 2, not_listed},
    {"nina", "cancel", 2, not_listed},
    {"robot", "approve", 1, "token robot is none"},
    // A number that none has may be any command's by the time that it is looked up.
    {"carl", "hold", 77, "needs a director"},
    {"carl", "cancel", 77, "needs a director"},
    {"carl", "release", 77, "carl may not release: it needs a director"},
    {"carl", "approve", 77, "carl may not approve: it needs a director"},
    {"nina", "hold", 77, "acts on no others"},
    {"director", "release", 77, ""},
    // What they may send they may hold and let go.
    {"carl", "hold", 1, ""},
    {"carl", "approve", 1, ""},
    {"nina", "hold", 1, ""},
    {"nina", "approve", 1, ""},
    {"robot", "hold", 1, ""},
    {"director", "hold", 2, ""},
    {"director", "approve", 2, ""},
};

}  // namespace

TEST_CASE("who may send a command that waits may act on it, and nobody else", "[access][http][stream]") {
    Guarded guarded;
    for (const char* user : {R"({"user":"carl","role":"controller","password":"given by another"})",
                             R"({"user":"nina","role":"director","password":"given by another","commands":["NO_OP"]})"})
        REQUIRE(guarded.ask("administrator", "POST", "/api/v1/users", user).status == 201);
    guarded.take_over("carl", "given by another");
    guarded.take_over("nina", "given by another");
    const auto token =
        guarded.ask("administrator", "POST", "/api/v1/tokens", R"({"name":"robot","role":"controller"})").body;
    guarded.as["robot"] = {{"Authorization", "Bearer " + token.substr(token.find(R"("token":")") + 9, 43)}};
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status == 201);
    const char* const commands = "/api/v1/runs/latest/commands";
    REQUIRE(guarded.ask("carl", "POST", commands, R"({"command":"NO_OP","hold":true})").status == 202);
    REQUIRE(guarded
                .ask("director", "POST", commands,
                     R"({"command":"EDL_DO_EDL","armed":true,"confirmation":"EDL_DO_EDL","hold":true})")
                .status == 202);

    for (const auto& [who, action, number, refusal] : of_the_queue) {
        const auto request = std::string{R"({"action":")"} + action + R"(","number":)" + std::to_string(number) + "}";
        const auto reply = guarded.ask(who, "POST", commands, request);
        StreamClient stream{guarded.server.port(), "aeolis.v1.json", guarded.as.at(who)};
        REQUIRE(stream.open());
        stream.send(R"({"command":)" + request + "}", false);
        const auto told = stream.receive();
        INFO(who << ' ' << request << " -> " << reply.status << ' ' << reply.body);
        REQUIRE(told);
        INFO(*told);
        CHECK((reply.status == 403) == !std::string_view{refusal}.empty());
        CHECK_THAT(reply.body, Catch::Contains(refusal));
        CHECK_THAT(*told, Catch::Contains(refusal));
        if (number == 77 && std::string_view{refusal}.empty())
            CHECK_THAT(reply.body, Catch::Contains("command 77 does not wait"));
    }
    const auto act = [&](const char* who, const char* request) { return guarded.ask(who, "POST", commands, request); };
    CHECK_THAT(act("carl", R"({"action":"release","number":1})").body, Catch::Contains(R"("accepted":true)"));
    CHECK_THAT(act("director", R"({"action":"cancel","number":2})").body,
               Catch::Contains(R"("accepted":true)"));  // it waited all the while
    CHECK_THAT(act("carl", R"({"action":"cancel","number":2})").body,
               Catch::Contains(hazardous));  // what it is stays known
    CHECK_THAT(
        guarded
            .ask("carl", "POST", "/api/v1/runs/latest/sequences", R"({"commands":[{"action":"release","number":1}]})")
            .body,
        Catch::Contains("action are not for a command of a sequence"));
}

TEST_CASE("what a person's token asks for that person cannot approve, and another can", "[access][http][R23][R63]") {
    Guarded guarded;
    REQUIRE(guarded
                .ask("administrator", "POST", "/api/v1/users",
                     R"({"user":"dora","role":"director","password":"given by another"})")
                .status == 201);
    guarded.take_over("dora", "given by another");
    const auto token = guarded
                           .ask("administrator", "POST", "/api/v1/tokens",
                                R"({"name":"robot","role":"controller","owner":"director"})")
                           .body;
    guarded.as["robot"] = {{"Authorization", "Bearer " + token.substr(token.find(R"("token":")") + 9, 43)}};
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"two_persons","pace":100})").status ==
            201);
    const auto send = [&](const char* who, const char* body) {
        return guarded.ask(who, "POST", "/api/v1/runs/latest/commands", body);
    };
    const char* const set = R"({"command":"EDL_SET_PARAMETERS","from_solution":true})";
    auto asked = send("robot", set);
    for (int i = 0; i < 3000 && asked.status != 202; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        asked = send("robot", set);
    }
    REQUIRE(asked.status == 202);
    const char* const approve = R"({"action":"approve","number":1})";
    CHECK_THAT(send("director", approve).body, Catch::Contains("was asked for by director: another controller"));
    CHECK_THAT(send("dora", approve).body, Catch::Contains(R"("accepted":true)"));
}

TEST_CASE("the script of an inline scenario is bound by the account's list, by each way to start it",
          "[access][http][stream]") {
    Guarded guarded;
    REQUIRE(guarded
                .ask("administrator", "POST", "/api/v1/users",
                     R"({"user":"nina","role":"director","password":"given by another","commands":["NO_OP"]})")
                .status == 201);
    guarded.take_over("nina", "given by another");
    const std::string start =
        R"({"inline_scenario":{"name":"x","entry_scet":"2012-08-06T05:10:47.4","commands":[{"send_before_entry_s":900,"command":"NO_OP"},)"
        R"({"send_before_entry_s":800,"command":"EDL_DO_EDL"}]}})";
    const auto says = Catch::Contains(
        "inline_scenario.commands[1]: nina may not send EDL_DO_EDL: it is not among the commands of this account");
    const auto refused = guarded.ask("nina", "POST", "/api/v1/rehearsals", start);
    CHECK(refused.status == 403);
    CHECK_THAT(refused.body, says);
    CHECK(guarded.ask("nina", "POST", "/api/v1/rehearsals/current", R"({"start":)" + start + "}").status == 403);
    StreamClient stream{guarded.server.port(), "aeolis.v1.json", guarded.as.at("nina")};
    REQUIRE(stream.open());
    stream.send(R"({"control":{"start":)" + start + "}}", false);
    const auto reply = stream.receive();
    REQUIRE(reply);
    CHECK_THAT(*reply, says);
    CHECK(guarded.ask("nina", "GET", "/api/v1/rehearsals/current").status == 404);  // none was begun
}

TEST_CASE("a script that breaks the timeline's constraints is refused at the start, by the command's name",
          "[access][http][R19]") {
    Guarded guarded;
    const std::string start =
        R"({"inline_scenario":{"name":"x","entry_scet":"2012-08-06T05:10:47.4","commands":[{"send_before_entry_s":900,"command":"EDL_SET_TIMEPOINT_OFFSET",)"
        R"("arguments":[{"name":"timepoint","value":9},{"name":"desired_offset_s","value":-5},{"name":"minimum_offset_s","value":0}]}]}})";
    const auto refused = guarded.ask("director", "POST", "/api/v1/rehearsals", start);
    CHECK(refused.status == 422);
    CHECK_THAT(refused.body, Catch::Contains("its script sends EDL_SET_TIMEPOINT_OFFSET: the changed timeline"));
    CHECK(guarded.ask("director", "GET", "/api/v1/rehearsals/current").status == 404);
}

TEST_CASE("who has not logged in sends no long body, and fills no audit", "[access][audit][http]") {
    Guarded guarded;
    const std::string long_body(5'000, ' ');
    CHECK(guarded.ask("nobody", "POST", "/api/v1/session", long_body).status == 413);
    CHECK(guarded.ask("observer", "POST", "/api/v1/session", long_body).status == 400);
    CHECK(guarded.ask("observer", "POST", "/api/v1/rehearsals", long_body).status == 413);  // which they may not start
    const std::string longer_body(50'000, ' ');
    CHECK(guarded.ask("director", "POST", "/api/v1/rehearsals", longer_body).status == 400);
    CHECK(guarded.ask("director", "POST", "/api/v1/runs/latest/notes", longer_body).status == 413);
    const auto count = [&] {
        const auto audit = guarded.ask("administrator", "GET", "/api/v1/audit").body;
        std::size_t entries = 0;
        for (auto at = audit.find("\"entry\""); at != std::string::npos; at = audit.find("\"entry\"", at + 1))
            ++entries;
        return entries;
    };
    std::this_thread::sleep_for(std::chrono::milliseconds{100});  // what the set-up did is written
    const auto before = count();
    for (int i = 0; i < 20; ++i) {
        guarded.ask("nobody", "POST", "/api/v1/session", R"({"user":"Not A Name","password":"x"})");
        guarded.ask("nobody", "POST", "/api/v1/rehearsals", "{}");
        guarded.ask("nobody", "GET", "/api/v1/audit");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    CHECK(count() == before);
}

TEST_CASE("what an instructor does is told to those who may instruct, to all others when the run is over, and bears "
          "the name of who is logged in",
          "[access][http][notes]") {
    Guarded guarded;
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status == 201);
    const char* const note = R"({"note":{"text":"do they see it?","by":"someone else"}})";
    CHECK(guarded.ask("controller", "POST", "/api/v1/rehearsals/current", note).status == 403);
    CHECK(guarded.ask("director", "POST", "/api/v1/rehearsals/current", note).status == 403);
    REQUIRE(guarded.ask("instructor", "POST", "/api/v1/rehearsals/current", note).status == 202);
    const char* const question = "/api/v1/runs/latest/interventions";
    const auto told_once = [&](const char* role, unsigned status, const char* says) {
        WebReply reply;
        for (int i = 0; i < 500; ++i, std::this_thread::sleep_for(std::chrono::milliseconds{20})) {
            reply = guarded.ask(role, "GET", question);
            if (reply.status == status && reply.body.find(says) != std::string::npos) break;
        }
        INFO(role << ": " << reply.body);
        CHECK(reply.status == status);
        CHECK_THAT(reply.body, Catch::Contains(says) && !Catch::Contains("someone else"));
    };
    told_once("instructor", 200, R"("by":"instructor")");
    told_once("director", 403, "told when the run and its forks are over");
    told_once("controller", 403, "told when the run and its forks are over");
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    told_once("observer", 200, "do they see it?");

    guarded.server.end();
    {
        auto database = archive::sqlite::Database::open(guarded.server.archive().string(),
                                                        archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        REQUIRE(database->execute("UPDATE runs SET state = 'running', last_seq = NULL")
                    .ok());  // as a server leaves it that is cut off
    }
    guarded.server.restart();
    guarded.as["observer"] = guarded.log_in("observer", Guarded::password);
    CHECK_THAT(guarded.ask("observer", "GET", "/api/v1/runs/latest").body, Catch::Contains(R"("state":"interrupted")"));
    told_once("observer", 403, "told when the run and its forks are over");  // it can be continued
}

TEST_CASE("a forecast from the truth does not exist for who may not instruct, and one by telemetry is everybody's",
          "[access][forecast][R58][idle]") {
    Guarded guarded;
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal_auto","pace":0})").status ==
            201);
    const auto wait = [&](const std::string& path, const std::string& words) {
        for (int i = 0; i < 3'000; ++i) {
            if (guarded.ask("instructor", "GET", path).body.find(words) != std::string::npos) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        return false;
    };
    REQUIRE(wait("/api/v1/runs/1", "\"finished\""));
    const std::string all = "/api/v1/runs/1/forecasts", truth = R"({"at":"E+6:00","cases":1})",
                      telemetry = R"({"at":"E+6:00","cases":1,"from":"telemetry"})";
    const auto seen = [&](const char* who) {
        return guarded.ask(who, "GET", all).body + guarded.ask(who, "GET", all + "/1").body +
               guarded.ask(who, "POST", all + "/1/cancel", "{}").body;
    };
    const auto before = seen("controller");
    REQUIRE(guarded.ask("instructor", "POST", all, truth).status == 201);
    REQUIRE(guarded.ask("instructor", "POST", all, truth).status == 201);
    CHECK(seen("controller") == before);
    CHECK(guarded.ask("controller", "POST", all, truth).status == 403);
    CHECK(guarded.ask("director", "POST", all, truth).status == 403);
    CHECK(guarded.ask("observer", "POST", all, telemetry).status == 403);

    const auto asked = guarded.ask("controller", "POST", all, telemetry);
    CHECK(asked.status == 201);
    CHECK_THAT(asked.body, Catch::Contains(R"("forecast":"2")"));
    for (const char* number : {"/1", "/2", "/3"}) REQUIRE(wait(all + number, R"("state":"ready")"));
    CHECK(guarded.ask("observer", "GET", all + "/1").status == 404);
    CHECK_THAT(guarded.ask("observer", "GET", all + "/2").body, Catch::Contains(R"("from":"telemetry")"));
    CHECK_THAT(guarded.ask("observer", "GET", all).body,
               Catch::Contains(R"("forecast":"2")") && !Catch::Contains(R"("forecast":"1")"));
    CHECK_THAT(guarded.ask("instructor", "GET", all).body, Catch::Contains(R"("forecast":"3")"));
}

TEST_CASE("a stream is closed when its log-in ends", "[access][stream]") {
    Guarded guarded;
    StreamClient client{guarded.server.port(), "aeolis.v1.json", guarded.as.at("observer")};
    REQUIRE(client.open());
    client.send(R"({"subscribe":{}})", false);
    REQUIRE(client.receive());
    CHECK(guarded.ask("observer", "DELETE", "/api/v1/session").status == 204);
    CHECK(guarded.ask("observer", "GET", "/api/v1/runs").status == 401);
    while (client.receive()) {
    }
    CHECK_THAT(client.close_words(), Catch::Contains("log in again"));
}

TEST_CASE("with positions a command needs the account that holds command, and the go of a director", "[access][R59]") {
    Guarded guarded;
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status == 201);
    const auto room = [&](const char* role, const char* body) {
        return guarded.ask(role, "POST", "/api/v1/runs/latest/positions", body);
    };
    const auto send = [&](const char* role) {
        return guarded.ask(role, "POST", "/api/v1/runs/latest/commands",
                           R"({"command":"NO_OP","controller":"controller"})");
    };
    CHECK(send("instructor").status == 202);  // nobody has a position
    CHECK_THAT(room("controller", R"({"kind":"take","position":"flight_director"})").body,
               Catch::Contains("flight_director needs a director, and controller is controller"));
    REQUIRE(room("director", R"({"kind":"take","position":"flight_director","by":"somebody else"})").status == 201);
    REQUIRE(room("controller", R"({"kind":"take","position":"command"})").status == 201);
    CHECK(send("controller").status == 409);
    REQUIRE(room("director", R"({"kind":"poll","position":"flight_director","subject":"a no op"})").status == 201);
    CHECK(room("director", R"({"kind":"go","position":"flight_director"})").status == 409);
    REQUIRE(room("controller", R"({"kind":"go","position":"command"})").status == 201);
    REQUIRE(room("director", R"({"kind":"go","position":"flight_director"})").status == 201);
    CHECK(send("controller").status == 202);
    const auto other = send("instructor");
    CHECK(other.status == 409);
    CHECK_THAT(other.body, Catch::Contains("command is held by controller, not by instructor"));
    SECTION("what was sent before a no go and is sent again is answered with its number") {
        const char* const once = R"({"command":"NO_OP","client_id":"once"})";
        const char* const commands = "/api/v1/runs/latest/commands";
        CHECK(guarded.ask("controller", "POST", commands, once).status == 202);
        REQUIRE(room("controller", R"({"kind":"no_go","position":"command","reason":"the station is down"})").status ==
                201);
        CHECK(send("controller").status == 409);
        const auto again = guarded.ask("controller", "POST", commands, once);
        CHECK(again.status == 202);
        CHECK_THAT(again.body, Catch::Contains("\"repeated\":true"));
    }
    SECTION("whoever is no director polls nobody") {
        const auto poll = room("controller", R"({"kind":"poll","position":"flight_director","subject":"x"})");
        CHECK(poll.status == 403);
        CHECK_THAT(poll.body, Catch::Contains("flight_director needs a director"));
    }
    SECTION("over the stream, too") {
        StreamClient console{guarded.server.port(), "aeolis.v1.json", guarded.as.at("instructor")};
        REQUIRE(console.open());
        console.send(R"({"command":{"request":1,"command":"NO_OP"}})", false);
        std::string told;
        while (told.find("command_reply") == std::string::npos) {
            const auto text = console.receive();
            REQUIRE(text);
            told = *text;
        }
        CHECK_THAT(told, Catch::Contains("command is held by controller, not by instructor"));
    }
}

TEST_CASE("a standard call is made from a position that is nobody else's, and another person reads it back",
          "[access][calls][R59]") {
    Guarded guarded;
    CHECK_THAT(guarded.ask("observer", "GET", "/api/v1/dictionary").body,
               Catch::Contains(R"({"call":"parachute_seen","key":"p","says":"Parachute seen","asks":""})"));
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})").status == 201);
    const auto say = [&](const char* role, const std::string& body) {
        return guarded.ask(role, "POST", "/api/v1/runs/latest/notes", body);
    };
    const auto read_back = [&](const char* role, const std::string& seq) {
        return say(role, R"({"position":"relay_and_station","reads_back":")" + seq + R"("})");
    };
    const auto seq_of = [](const WebReply& reply) {
        constexpr std::string_view begin = R"("seq":")";
        const auto at = reply.body.find(begin) + begin.size();
        return reply.body.substr(at, reply.body.find('"', at) - at);
    };
    const char* const parachute = R"({"call":"parachute_seen","position":"edl_communications"})";
    CHECK(say("observer", parachute).status == 403);
    const auto made = say("controller", parachute);
    REQUIRE(made.status == 201);
    CHECK_THAT(made.body, Catch::Contains(R"("text":"EDL communications: Parachute seen")") &&
                              Catch::Contains(R"("call":"parachute_seen")"));
    const auto own = read_back("controller", seq_of(made));
    CHECK(own.status == 409);
    CHECK_THAT(own.body, Catch::Contains("another person reads it back"));
    const auto token = guarded
                           .ask("administrator", "POST", "/api/v1/tokens",
                                R"({"name":"echo","role":"controller","owner":"controller"})")
                           .body;
    guarded.as["echo"] = {{"Authorization", "Bearer " + token.substr(token.find(R"("token":")") + 9, 43)}};
    CHECK(read_back("echo", seq_of(made)).status == 409);  // a person's program is no second person
    CHECK_THAT(say("echo", R"({"text":"heard"})").body, Catch::Contains(R"("by":"controller")"));
    const auto heard = read_back("director", seq_of(made));
    REQUIRE(heard.status == 201);
    CHECK_THAT(heard.body, Catch::Contains("Relay and station: reads back “EDL communications: Parachute seen”") &&
                               Catch::Contains(R"("reads_back":")" + seq_of(made)));
    CHECK(read_back("controller", seq_of(heard)).status == 422);  // no call itself
    CHECK(read_back("controller", "1000000").status == 422);
    CHECK(say("controller", R"({"call":"tone_heard"})").status == 422);  // which one?
    CHECK(say("controller", R"({"call":"chute"})").status == 422);
    REQUIRE(guarded
                .ask("instructor", "POST", "/api/v1/runs/latest/positions",
                     R"({"kind":"take","position":"edl_communications"})")
                .status == 201);
    const auto of_another = say("controller", parachute);
    CHECK(of_another.status == 409);
    CHECK_THAT(of_another.body, Catch::Contains("edl_communications is held by instructor"));
    REQUIRE(guarded.ask("director", "POST", "/api/v1/rehearsals/current", R"({"stop":true})").status == 202);
    for (int i = 0; i < 500 && say("instructor", parachute).status == 201; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    CHECK_THAT(say("instructor", parachute).body, Catch::Contains("calls are made while a run does"));
    CHECK(say("instructor", R"({"text":"a note of the day after"})").status == 201);
}

TEST_CASE("what was done, by whom and with what outcome, is in the audit, and no password is", "[access][audit]") {
    Guarded guarded;
    guarded.ask("controller", "POST", "/api/v1/runs/latest/commands",
                R"({"command":"NO_OP","client_id":"only-looked","dry_run":true})");
    guarded.ask("controller", "POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP","client_id":"was-sent"})");
    guarded.ask("controller", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})");
    guarded.ask("director", "POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})");
    CHECK(guarded.ask("controller", "PATCH", "/api/v1/users/director", R"({"role":"observer"})").status == 403);
    web_request(guarded.server.port(), "POST", "/api/v1/session", R"({"user":"director","password":"a wrong guess"})");
    std::string audit;
    for (int i = 0; i < 3000 && audit.find("director\",\"outcome\":\"refused") == std::string::npos; ++i) {
        audit = guarded.ask("administrator", "GET", "/api/v1/audit").body;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK_THAT(audit, Catch::Contains(R"("who":"controller","from":"127.0.0.1","action":"rehearsal")") &&
                          Catch::Contains("refused (403)"));
    CHECK_THAT(audit, Catch::Contains(R"("who":"director","from":"127.0.0.1","action":"rehearsal")"));
    CHECK_THAT(audit, Catch::Contains("add 'observer' as observer"));
    CHECK_THAT(audit, Catch::Contains("change 'director'\",\"outcome\":\"refused"));
    CHECK_THAT(audit, Catch::Contains("user or password is wrong"));
    CHECK_THAT(audit, Catch::Contains("was-sent") && !Catch::Contains("only-looked"));  // a dry run is no action
    CHECK_THAT(audit, !Catch::Contains("given by another") && !Catch::Contains(Guarded::password) &&
                          !Catch::Contains("a wrong guess"));
}

TEST_CASE("a password that was reset by hand is in the audit of the server that runs, or of the next, once",
          "[access][audit]") {
    Guarded guarded;
    const auto reset = [&](const char* user) {  // as `aeolis accounts reset`
        const server::AccountsLock lock{guarded.server.accounts()};
        auto accounts = server::read_accounts(guarded.server.accounts());
        REQUIRE(accounts);
        server::reset_account(*accounts, user);
        auto& told = *accounts->add_resets();
        told.set_user(user);
        told.set_by("root");
        REQUIRE(server::write_accounts(guarded.server.accounts(), *accounts));
    };
    auto reader = archive::Reader::open(guarded.server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto told = [&](const char* user) {
        return std::ranges::count_if(reader->audit(0, 1'000).value(), [&](const auto& entry) {
            return entry.who == "root" &&
                   entry.detail.find(fmt::format("a new password for '{}'", user)) != std::string::npos;
        });
    };
    reset("controller");
    for (int i = 0; i < 500 && told("controller") == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    CHECK(told("controller") == 1);
    guarded.server.end();
    reset("director");
    guarded.server.restart();
    guarded.server.end();
    CHECK(told("director") == 1);
    CHECK(told("controller") == 1);
    CHECK(server::read_accounts(guarded.server.accounts())->resets().empty());
}

}  // namespace server_authority_test
