#include "aeolis/v1/run.pb.h"
#include "server/api/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>

using namespace aeolis;
using namespace aeolis::test;
using server::from_json;

namespace {

struct Asked {
    const char* method;
    const char* target;
    const char* body;
    unsigned status;
    const char* says;
};

} // namespace

TEST_CASE("every route answers what it can and refuses the rest by name", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    const auto port = server.port();
    for (int i = 0; i < 200; ++i) { // the run is there as soon as it is in the archive
        if (web_request(port, "GET", "/api/v1/runs/1").status == 200) break;
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    const Asked table[] = {
        {"GET", "/healthz", "", 200, "ok"},
        {"GET", "/metrics", "", 200, "\naeolis_resident_memory_bytes "},
        {"GET", "/metrics", "", 200, "\naeolis_archive_commit_seconds_count "},
        {"GET", "/api/v1/openapi.yaml", "", 200, "openapi: 3"},
        {"GET", "/api/v1/runs", "", 200, "\"scenario\":\"nominal\""},
        {"GET", "/api/v1/runs/latest", "", 200, "\"state\":\"running\""},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m", "", 200, "\"name\":\"altitude_m\""},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=csv", "", 200, "channel,unit,sclk_s,value,source"},
        {"GET", "/api/v1/runs/1/samples?names=altitude_m", "", 200, "sclk,e_s,channel,value,unit,source\n"},
        {"GET", "/api/v1/runs/1/samples?format=jsonl&to=1", "", 200, ""},
        {"GET", "/api/v1/runs/1/samples?names=speed_mps,altitude_m&align=speed_mps", "", 200, "sclk,e_s,speed_mps,altitude_m\n"},
        {"GET", "/api/v1/runs/1/samples?names=speed_mps&align=mach", "", 400, "align: 'mach'"},
        {"GET", "/api/v1/runs/1/samples?format=xlsx", "", 400, "neither csv nor jsonl"},
        {"GET", "/api/v1/runs/1/samples?names=altitud", "", 400, "altitud"},
        {"GET", "/api/v1/runs/1/samples?from=2&to=1", "", 400, "upside down"},
        {"GET", "/api/v1/runs/1/samples?limit=1", "", 400, "limit"},
        {"GET", "/api/v1/runs/9/samples", "", 404, "9"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=protobuf", "", 200, "altitude_m"},
        {"GET", "/api/v1/runs/1/packets?apid=0x20&limit=5", "", 200, "\"packets\":["},
        {"GET", "/api/v1/runs/1/tones", "", 200, "\"tones\":["},
        {"GET", "/api/v1/runs/1/events?level=FATAL&text=x", "", 200, "\"events\":["},
        {"GET", "/api/v1/runs/1/commands", "", 200, "\"commands\":["},
        {"GET", "/api/v1/runs/1/timepoints", "", 200, "\"timepoints\":["},
        {"GET", "/api/v1/runs/1/explanations", "", 200, "\"explanations\":["},
        {"GET", "/api/v1/runs/1/recording", "", 200, "\"realtime_differs\":\"0\""},
        {"GET", "/api/v1/runs/1/report", "", 200, "\"timepoints\":["},
        {"GET", "/api/v1/runs/1/state", "", 200, "\"channels\":["},
        {"GET", "/api/v1/scenarios", "", 200, "nominal_auto"},
        {"GET", "/api/v1/rehearsals", "", 200, "\"run\":\"1\""},
        {"GET", "/api/v1/rehearsals/current", "", 200, "\"run\":\"1\""},
        {"GET", "/api/v1/dictionary", "", 200, "EDL_DO_EDL"},
        {"PATCH", "/api/v1/rehearsals/current", R"({"pace": 50})", 202, "\"run\":\"1\""},

        {"GET", "/api/v1/runs/1/alarms", "", 200, "\"changes\":["},
        {"GET", "/api/v1/runs/1/alarms?state=current", "", 200, "\"alarms\":["},
        {"GET", "/api/v1/runs/1/alarms?state=past", "", 400, "state"},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"speed_mps","action":"acknowledge","by":"Ada"})", 409, "speed_mps is normal"},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"GNC-0007","action":"shelve","shelve_s":60,"by":"Ada"})", 201, "\"until\":\""},
        {"GET", "/api/v1/runs/1/alarms?state=current", "", 200, "\"state\":\"shelved\""},
        {"POST", "/api/v1/runs/1/alarms", R"({"channel":"moon","action":"shelve","shelve_s":60,"by":"Ada"})", 422, "moon"},
        {"POST", "/api/v1/runs/1/alarms", R"({"canal":"moon"})", 400, "canal"},
        {"POST", "/api/v1/runs/9/alarms", R"({"channel":"speed_mps","action":"shelve","shelve_s":60,"by":"Ada"})", 404, "9"},
        {"POST", "/api/v1/runs/latest/notes", R"({"text":"all <b>well</b>","by":"Ada","sclk":1.5})", 201, "\\u003cb\\u003ewell"},
        {"GET", "/api/v1/runs/1/notes?text=WELL", "", 200, "\"by\":\"Ada\""},
        {"POST", "/api/v1/runs/1/notes", R"({"text":"","by":"Ada"})", 422, "empty"},
        {"POST", "/api/v1/runs/1/notes", R"({"text":"x"})", 422, "by:"},
        {"GET", "/api/v1/runs/1/commands?text=NO_OP", "", 200, "\"commands\":["},
        {"GET", "/api/v1/runs/1/explanations?text=nothing%22", "", 200, "\"explanations\":["},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps*2%2B%7BGNC-0007%7D&points=20", "", 200, "\"name\":\"speed_mps*2"},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps*(2", "", 400, "character"},
        {"GET", "/api/v1/runs/1/channels?expression=speed_mps&names=speed_mps", "", 400, "not both"},

        {"GET", "/api/v1/nothing", "", 404, "no such route"},
        {"GET", "/api/v1/runs/99", "", 404, "99"},
        {"GET", "/api/v1/runs/0/events", "", 404, "run '0'"},
        {"GET", "/api/v1/runs/99999999999/events", "", 404, "99999999999"},
        {"GET", "/api/v1/runs/1/feelings", "", 404, "feelings"},
        {"GET", "/api/v1/runs/1/channels", "", 400, "names"},
        {"GET", "/api/v1/runs/1/channels?names=moon_phase", "", 400, "moon_phase"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&from=5&to=3", "", 400, "upside down"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&from=five", "", 400, "five"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&points=0", "", 400, "points"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&format=xml", "", 400, "xml"},
        {"GET", "/api/v1/runs/1/channels?names=altitude_m&colour=red", "", 400, "colour"},
        {"GET", "/api/v1/runs/1/events?level=PANIC", "", 400, "PANIC"},
        {"GET", "/api/v1/runs/1/events?limit=1000000", "", 400, "limit"},
        {"GET", "/api/v1/runs/1/explanations?decision=zz", "", 400, "zz"},
        {"GET", "/api/v1/runs/1/packets?apid=0x30", "", 400, "share"},
        {"GET", "/api/v1/runs/1/packets?apid=9999999", "", 400, "apid"},
        {"DELETE", "/api/v1/runs/1/events", "", 405, "DELETE"},
        {"POST", "/api/v1/runs", "{}", 405, "POST"},
        {"GET", "/api/v1/stream", "", 426, "WebSocket"},
        {"POST", "/api/v1/rehearsals", "{", 400, "StartRehearsal"},
        {"POST", "/api/v1/rehearsals", R"({"senario":"nominal"})", 400, "senario"},
        {"POST", "/api/v1/rehearsals", R"({"scenario":"nominal","pace":1})", 409, "goes on"},
        {"POST", "/api/v1/rehearsals/current", R"({"pace":100000})", 422, "pace"},
        {"POST", "/api/v1/rehearsals/current", "{}", 422, "says nothing"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":"NO_SUCH"})", 422, "NO_SUCH"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":5})", 400, "CommandRequest"},
        {"POST", "/api/v1/runs/1/commands", R"({"command":"NO_OP","run":"2"})", 400, "the path says 1"},
        {"POST", "/api/v1/runs/2/commands", R"({"command":"NO_OP"})", 409, "not the one that goes on"},
        {"POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP"})", 202, "\"accepted\":true"},
    };
    for (const auto& asked : table) {
        const auto reply = web_request(port, asked.method, asked.target, asked.body);
        INFO(asked.method << ' ' << asked.target << ' ' << asked.body << " -> " << reply.body.substr(0, 300));
        CHECK(reply.status == asked.status);
        CHECK_THAT(reply.body, Catch::Contains(asked.says));
        const bool is_command = std::string_view{asked.target}.ends_with("/commands") && (reply.status == 409 || reply.status == 422);
        if (reply.status >= 400) // a command that was refused is answered by its own message
            CHECK_THAT(reply.body, Catch::StartsWith(is_command ? "{\"request\":" : "{\"error\":"));
    }
}

TEST_CASE("samples in Protobuf are those in JSON, bit for bit, in less than half the octets", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal_auto"), 100.0};
    const auto ask = [&](const std::string& more) {
        return web_request(server.port(), "GET", "/api/v1/runs/1/channels?names=altitude_m,speed_mps" + more);
    };
    WebReply json, octets;
    for (int i = 0; i < 500 && json.body.size() < 20'000; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
        json = ask("");
    }
    CHECK(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"pause":true})").status == 202);
    v1::ChannelSeriesList list;
    for (int i = 0; i < 50; ++i) { // until what was on its way has come
        octets = ask("&format=protobuf");
        json = ask("");
        if (ask("&format=protobuf").body == octets.body) break;
    }
    CHECK(octets.content_type == "application/x-protobuf");
    REQUIRE(from_json(json.body, list).ok());
    CHECK(list.channels(0).sclk_size() > 100);
    CHECK(list.SerializeAsString() == octets.body);
    CHECK(2 * octets.body.size() < json.body.size());
}

TEST_CASE("a rehearsal that cannot be is refused with what is wrong, and the next one begins", "[http][R45]") {
    RunningServer server;
    const auto post = [&](std::string_view body) {
        return web_request(server.port(), "POST", "/api/v1/rehearsals", std::string{body});
    };
    const auto unknown = post(R"({"scenario":"../etc/passwd","pace":1})");
    CHECK(unknown.status == 422);
    CHECK_THAT(unknown.body, Catch::Contains("there is none of this name"));
    const auto slow = post(R"({"scenario":"nominal","pace":0.5})");
    CHECK(slow.status == 422);
    CHECK_THAT(slow.body, Catch::Contains("pace"));
    CHECK(web_request(server.port(), "POST", "/api/v1/rehearsals/current", R"({"pause":true})").status == 409);
    CHECK(post(R"({"scenario":"nominal","pace":1})").status == 201);
}

TEST_CASE("what was acknowledged is durable: the command is in the archive when the reply comes", "[http][R43]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    WebReply reply;
    for (int i = 0; i < 200 && reply.status != 202; ++i) {
        reply = web_request(server.port(), "POST", "/api/v1/runs/latest/commands", R"({"command":"NO_OP"})");
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    REQUIRE(reply.status == 202);
    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto commands = reader->commands(archive::RunId{1});
    REQUIRE(commands);
    REQUIRE(commands->commands_size() == 1);
    CHECK(commands->commands(0).stages_size() >= 4);
}

TEST_CASE("a command file goes whole or not at all, and names the command that is refused", "[http][R44]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    const auto post = [&](std::string_view body) { return web_request(server.port(), "POST", "/api/v1/runs/latest/sequences", body); };
    WebReply reply;
    for (int i = 0; i < 200 && reply.status != 202; ++i) {
        reply = post(R"({"dry_run":true,"commands":[{"command":"NO_OP"},{"command":"NO_OP"}]})");
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK_THAT(reply.body, Catch::StartsWith(R"({"accepted":true)") && Catch::Contains(R"("dry_run":true)"));
    const auto spoilt = post(R"({"commands":[{"command":"NO_OP"},{"command":"EDL_DO_EDL"}]})");
    CHECK(spoilt.status == 409);
    CHECK_THAT(spoilt.body, Catch::Contains("commands[1]: EDL_DO_EDL is hazardous"));
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/commands").body, Catch::StartsWith(R"({"commands":[])"));
    const auto taken = post(R"({"commands":[{"command":"NO_OP","request":"5"},{"command":"NO_OP","hold":true}]})");
    CHECK(taken.status == 202);
    CHECK_THAT(taken.body, Catch::Contains(R"("request":"5","command":"1")") && Catch::Contains(R"("command":"2")"));
    CHECK(post(R"({"commands":[]})").status == 400);
    CHECK_THAT(post(R"({"commands":[{"command":"NO_OP","dry_run":true}]})").body, Catch::Contains("commands[0]: dry_run"));
}

TEST_CASE("a command that would break a constraint of the timeline is refused before it is sent, and the constraint is named", "[http][R19]") {
    RunningServer server{shipped_scenario("nominal"), 1.0}; // the run outlasts the analysis, however slow the build
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row = std::ranges::find(timeline, "cruise_stage_separation", &dictionary::TimelineRow::name) - timeline.begin();
    const auto ask = [&](double desired_s, double minimum_s, bool dry_run) {
        const auto body = fmt::format(R"({{"command":"EDL_SET_TIMEPOINT_OFFSET","dry_run":{},"arguments":[{{"name":"timepoint","value":{}}},)"
                                      R"({{"name":"desired_offset_s","value":{}}},{{"name":"minimum_offset_s","value":{}}}]}})",
                                      dry_run, row, desired_s, minimum_s);
        return web_request(server.port(), "POST", "/api/v1/runs/latest/commands", body);
    };
    WebReply reply;
    for (int i = 0; i < 3000 && reply.status != 202; ++i) { // a slow build is long in starting the run
        reply = ask(-600.0, 2.0, true);
        if (reply.status != 202) std::this_thread::sleep_for(std::chrono::milliseconds{20});
    }
    CHECK_THAT(reply.body, Catch::Contains("bounds of constraints.csv hold on the changed timeline"));
    const auto broken = ask(-620.0, 0.0, false); // at once behind the cutters, which need their two seconds
    INFO(broken.body);
    CHECK(broken.status == 409);
    CHECK_THAT(broken.body, Catch::Contains("breaks a constraint") && Catch::Contains("cruise_stage_separation") && Catch::Contains("constraints.csv:"));
}

TEST_CASE("a page of another site, or a name bound to this address, gets nothing", "[http]") {
    RunningServer server;
    const auto status = [&](const Headers& headers) {
        return web_request(server.port(), "GET", "/api/v1/runs", "", headers).status;
    };
    CHECK(status({}) == 200);
    CHECK(status({{"Host", "localhost:8080"}, {"Origin", "http://localhost:8080"}}) == 200);
    CHECK(status({{"Host", "[::1]:8080"}, {"Origin", "http://[::1]:8080"}}) == 200);
    CHECK(status({{"Host", "localhost:8080"}, {"Origin", "http://localhost:5173"}}) == 403);
    CHECK(status({{"Origin", "https://evil.example"}}) == 403);
    CHECK(status({{"Origin", "null"}}) == 403);
    CHECK(status({{"Origin", "http://localhost.evil.example"}}) == 403);
    CHECK(status({{"Host", "evil.example"}}) == 403);
    CHECK(status({{"Host", "localhost"}}) == 200);
    CHECK_FALSE(StreamClient{server.port(), "aeolis.v1.json", {{"Origin", "http://evil.example"}}}.open());
}

TEST_CASE("what is no HTTP, too long or cut off costs its own connection only", "[http]") {
    RunningServer server;
    const auto port = server.port();
    CHECK_THAT(raw_exchange(port, "this is not HTTP\r\n\r\n"), Catch::StartsWith("HTTP/1.1 400"));
    CHECK_THAT(raw_exchange(port, "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n"),
               Catch::StartsWith("HTTP/1.1 413"));
    CHECK_THAT(
        raw_exchange(port, "POST /api/v1/rehearsals HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2000000\r\n\r\n"),
        Catch::StartsWith("HTTP/1.1 413") && Catch::Contains("1048576"));
    raw_exchange(port, "GET /api/v1/runs HTT");
    CHECK_THAT(raw_exchange(port, "GET /%zz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
               Catch::StartsWith("HTTP/1.1 400"));
    CHECK(web_request(port, "GET", "/healthz").status == 200);
}

TEST_CASE("the console's files are served, and nothing outside its folder", "[http][R45]") {
    RunningServer server;
    const auto port = server.port();
    CHECK(web_request(port, "GET", "/").status == 503);
    CHECK_THAT(web_request(port, "GET", "/").body, Catch::Contains("not built"));
    const auto web = server.archive().parent_path() / "web";
    std::filesystem::create_directories(web / "assets");
    std::ofstream{web / "index.html"} << "<!doctype html>console";
    std::ofstream{web / "assets/app-1a2b.js"} << "export {}";
    const auto page = web_request(port, "GET", "/plots/altitude");
    CHECK(page.status == 200);
    CHECK(page.content_type == "text/html; charset=utf-8");
    CHECK(page.cache_control == "no-cache");
    const auto script = web_request(port, "GET", "/assets/app-1a2b.js");
    CHECK(script.content_type == "text/javascript; charset=utf-8");
    CHECK_THAT(script.cache_control, Catch::Contains("immutable"));
    CHECK(web_request(port, "HEAD", "/").status == 200);
    for (const char* outside :
         {"/../a.db", "/%2e%2e/a.db", "/assets/../../a.db", "/..%2fa.db", "//etc/passwd.x", "/none.js"})
        CHECK(web_request(port, "GET", outside).status == 404);
}

TEST_CASE("a second server on the port, or another address, is refused in one line", "[http]") {
    RunningServer server;
    server::ConsoleBackend::Settings settings;
    settings.web_server.port = server.port();
    settings.archive = server.archive().parent_path() / "other.db";
    const auto second = server::ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE_FALSE(second);
    CHECK_THAT(second.error().message, Catch::Contains("in use"));
    CHECK_FALSE(std::filesystem::exists(settings.archive));
    settings.web_server.address = "0.0.0.0";
    CHECK_THAT(server::ConsoleBackend::open(settings, tests::shipped_dictionary()).error().message,
               Catch::Contains("loopback only"));
    settings.web_server.address = "127.0.0.1";
    settings.web_server.port = 0;
    settings.archive = server.archive();
    const auto same_archive = server::ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE_FALSE(same_archive);
    CHECK(web_request(server.port(), "GET", "/healthz").status == 200);
}
