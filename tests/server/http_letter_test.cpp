// SPDX-License-Identifier: Apache-2.0
// HTTP to the letter of RFC 9110 and 9112, case by case: where a request ends, whom it is for, what may be expected.
// The spellings of Transfer-Encoding are those of the default list of the tool smuggler (github.com/defparam/smuggler),
// by its names.
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <fmt/format.h>
#include <string>
#include <vector>

namespace server_http_letter_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace std::string_literals;

namespace {

int responses_in(const std::string& octets) {
    int number = 0;
    for (auto at = octets.find("HTTP/1.1 "); at != std::string::npos; at = octets.find("HTTP/1.1 ", at + 1)) ++number;
    return number;
}

constexpr const char* smuggled = "GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

}  // namespace

TEST_CASE("where a request ends is said once and plainly, or it is refused and its connection closes", "[http][R63]") {
    RunningServer server;
    const std::string body = "0\r\n\r\n"s + smuggled;
    const std::string length = fmt::format("Content-Length: {}\r\n", body.size());
    struct Case {
        const char* name;
        std::string fields;
    };
    const std::vector<Case> refused = {
        {"two Hosts", "Host: localhost\r\n" + length},
        {"two equal Content-Lengths", length + length},
        {"two Content-Lengths", length + "Content-Length: 5\r\n"},
        {"a list of Content-Lengths", fmt::format("Content-Length: {0}, {0}\r\n", body.size())},
        {"a signed Content-Length", "Content-Length: +5\r\n"},
        {"a negative Content-Length", "Content-Length: -5\r\n"},
        {"a hexadecimal Content-Length", "Content-Length: 0x5\r\n"},
        {"an empty Content-Length", "Content-Length: \r\n"},
        {"both lengths", length + "Transfer-Encoding: chunked\r\n"},
        {"chunked, identity", "Transfer-Encoding: chunked, identity\r\n"},
        {"identity", "Transfer-Encoding: identity\r\n" + length},
        {"gzip, chunked", "Transfer-Encoding: gzip, chunked\r\n"},
        {"two Transfer-Encodings", "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"},
        // smuggler
        {"vanilla", length + "Transfer-Encoding: chunked\r\n"},
        {"tabprefix1", length + "Transfer-Encoding:\tchunked\r\n"},
        {"tabprefix2", length + "Transfer-Encoding\t:\tchunked\r\n"},
        {"spacejoin1", length + "Transfer Encoding: chunked\r\n"},
        {"smashed", length + "Transfer Encoding:chunked\r\n"},
        {"space1", length + "Transfer-Encoding : chunked\r\n"},
        {"valueprefix1", length + "Transfer-Encoding:  chunked\r\n"},
        {"vertprefix1", length + "Transfer-Encoding:\x0b" + "chunked\r\n"},
        {"commaCow", length + "Transfer-Encoding: chunked, cow\r\n"},
        {"cowComma", length + "Transfer-Encoding: cow, chunked\r\n"},
        {"linewrapped1", length + "Transfer-Encoding:\n chunked\r\n"},
        {"quoted", length + "Transfer-Encoding: \"chunked\"\r\n"},
        {"aposed", length + "Transfer-Encoding: 'chunked'\r\n"},
        {"lazygrep", length + "Transfer-Encoding: chunk\r\n"},
        {"sarcasm", length + "TrAnSFer-EnCODinG: cHuNkeD\r\n"},
        {"yelling", length + "TRANSFER-ENCODING: CHUNKED\r\n"},
        {"0dsuff", length + "Transfer-Encoding: chunked\r\r\n"},
        {"tabsuff", length + "Transfer-Encoding: chunked\t\r\n"},
        {"revdualchunk", length + "Transfer-Encoding: cow\r\nTransfer-Encoding: chunked\r\n"},
        {"nested", length + "Transfer-Encoding: cow chunked bar\r\n"},
        {"spaceFF", length + "Transfer-Encoding:\xFF" + "chunked\r\n"},
        {"accentCH", length + "Transfer-Encoding: ch\x96nked\r\n"},
        {"x-prefix", length + "Transfer-Encoding: xchunked\r\n"},
        {"nulprefix", length + "Transfer-Encoding:\x00"s + "chunked\r\n"},
    };
    for (const auto& [name, fields] : refused) {
        CAPTURE(name);
        const auto answer = raw_exchange(server.port(), "POST /api/v1/session HTTP/1.1\r\nHost: localhost\r\n" +
                                                            fields + "\r\n" + body);
        INFO(answer);
        CHECK(responses_in(answer) == 1);
        CHECK_THAT(answer, Catch::StartsWith("HTTP/1.1 400 ") && Catch::Contains("application/problem+json"));
    }
    // Names that only look alike say nothing: the body is as long as its length says, and what is in it is no request.
    for (const auto* name :
         {"Transfer_Encoding: chunked", "Content-Encoding: chunked", "X: Transfer-Encoding: chunked"}) {
        CAPTURE(name);
        const auto answer = raw_exchange(server.port(), "POST /api/v1/session HTTP/1.1\r\nHost: localhost\r\n" +
                                                            length + name + "\r\n\r\n" + body);
        CHECK(responses_in(answer) == 1);
    }
    const auto old = raw_exchange(server.port(), "POST /api/v1/session HTTP/1.0\r\nHost: localhost\r\n"
                                                 "Transfer-Encoding: chunked\r\n\r\n" +
                                                     body);
    CHECK_THAT(old, Catch::Contains("400 Bad Request") && Catch::Contains("HTTP/1.0 has none"));
}

TEST_CASE("a request is for the host that it names, once", "[http][R63]") {
    RunningServer server;
    const auto ask = [&](const std::string& head) {
        return raw_exchange(server.port(), head + "Connection: close\r\n\r\n");
    };
    CHECK_THAT(ask("GET /healthz HTTP/1.1\r\n"),
               Catch::StartsWith("HTTP/1.1 400 ") && Catch::Contains("Host: is missing"));
    CHECK_THAT(ask("GET /healthz HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n"),
               Catch::StartsWith("HTTP/1.1 400 "));
    CHECK_THAT(ask("GET http://localhost/healthz HTTP/1.1\r\nHost: evil.example\r\n"),
               Catch::StartsWith("HTTP/1.1 200 "));
    CHECK_THAT(ask("GET http://evil.example/healthz HTTP/1.1\r\nHost: localhost\r\n"),
               Catch::StartsWith("HTTP/1.1 403 "));
    CHECK_THAT(ask("GET ftp://localhost/healthz HTTP/1.1\r\nHost: localhost\r\n"), Catch::StartsWith("HTTP/1.1 400 "));
    CHECK_THAT(ask("CONNECT localhost:443 HTTP/1.1\r\nHost: localhost\r\n"), Catch::StartsWith("HTTP/1.1 400 "));
}

TEST_CASE("methods, paths and expectations that are none here are refused by their own status", "[http][R63]") {
    RunningServer server;
    const auto ask = [&](const std::string& head, const std::string& more = "") {
        return raw_exchange(server.port(),
                            head + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + more + "\r\n");
    };
    CHECK_THAT(ask("DELETE /api/v1/runs"),
               Catch::StartsWith("HTTP/1.1 405 ") && Catch::Contains("\r\nAllow: GET, HEAD\r\n"));
    CHECK_THAT(ask("OPTIONS /api/v1/session"),
               Catch::StartsWith("HTTP/1.1 405 ") && Catch::Contains("\r\nAllow: GET, POST, DELETE, HEAD\r\n"));
    CHECK_THAT(ask("PUT /"), Catch::StartsWith("HTTP/1.1 405 ") && Catch::Contains("\r\nAllow: GET, HEAD\r\n"));
    for (const char* path : {"/healthz/", "/api", "/api/", "/api/v2/runs", "/api/v1", "/metrics/", "/plots/altitude"})
        CHECK_THAT(ask("GET "s + path),
                   Catch::StartsWith("HTTP/1.1 404 ") && Catch::Contains("application/problem+json") &&
                       Catch::Contains(R"("type":"about:blank","title":"Not Found","status":404)"));
    const auto invited = ask("POST /api/v1/session", "Expect: 100-continue\r\nContent-Length: 2\r\n");
    CHECK_THAT(invited, Catch::StartsWith("HTTP/1.1 100 Continue\r\n\r\n"));
    const auto too_long = ask("POST /api/v1/rehearsals", "Expect: 100-continue\r\nContent-Length: 2000000\r\n");
    CHECK_THAT(too_long, Catch::StartsWith("HTTP/1.1 413 "));
    CHECK_THAT(ask("POST /api/v1/session", "Expect: tea\r\nContent-Length: 2\r\n"), Catch::StartsWith("HTTP/1.1 417 "));
}

TEST_CASE("an encoded slash separates no parts of a path, and no path has a NUL character", "[http][R63]") {
    RunningServer server{shipped_scenario("nominal"), 1.0};
    const auto ask = [&](const char* target) { return web_request(server.port(), "GET", target); };
    for (int i = 0; i < 3000 && ask("/api/v1/runs/1").status != 200; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    CHECK(ask("/api/v1/%72uns/%31").status == 200);
    for (const char* target : {"/api/v1/runs%2F1", "/api/v1%2fruns/1", "/api/v1/runs/1%2Fevents", "/%2fhealthz"})
        CHECK(ask(target).status == 404);
    const auto layout = web_request(server.port(), "PUT", "/api/v1/layouts/day%2Fnight", R"({"view":"panel=tones"})");
    CHECK(layout.status == 422);  // a name that no layout has; not a route that is none
    CHECK_THAT(layout.body, Catch::Contains("name: 1 to 40 of letters"));
    for (const char* target : {"/index.html%00.js", "/healthz%00", "http://localhost/%00"}) {
        const auto reply = ask(target);
        CHECK(reply.status == 400);
        CHECK_THAT(reply.body, Catch::Contains("NUL character"));
    }
}

TEST_CASE("a refusal names what would be accepted: the scheme of 401, the protocol of 426", "[http][access][R63]") {
    RunningServer server{RunningServer::WithAccounts{}};
    const auto ask = [&](const std::string& head, const std::string& more = "") {
        return raw_exchange(server.port(),
                            head + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + more + "\r\n");
    };
    const auto upgrade = [&](const std::string& more) {
        return raw_exchange(server.port(), "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
                                           "Connection: Upgrade, close\r\nSec-WebSocket-Protocol: aeolis.v1.json\r\n" +
                                               more + "\r\n");
    };
    constexpr const char* body = R"({"user":"administrator","password":"wrong"})";
    for (const auto& answer : {ask("GET /api/v1/runs"), ask("GET /api/v1/stream"), upgrade(""),
                               ask("POST /api/v1/session",
                                   fmt::format("Content-Length: {}\r\n\r\n{}", std::string_view{body}.size(), body))})
        CHECK_THAT(answer, Catch::StartsWith("HTTP/1.1 401 ") && Catch::Contains("\r\nWWW-Authenticate: Bearer\r\n") &&
                               Catch::Contains("application/problem+json"));

    RunningServer open;
    const auto ask_open = [&](const std::string& octets) { return raw_exchange(open.port(), octets); };
    const std::string head = "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n", close = "Connection: close\r\n\r\n";
    const std::string wants = head + "Upgrade: websocket\r\nSec-WebSocket-Protocol: aeolis.v1.json\r\n"
                                     "Connection: Upgrade, close\r\n";
    const std::string key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    for (const auto& request : {head + close, wants + key + "Sec-WebSocket-Version: 8\r\n\r\n", wants + key + "\r\n"})
        CHECK_THAT(ask_open(request), Catch::StartsWith("HTTP/1.1 426 ") &&
                                          Catch::Contains("\r\nUpgrade: websocket\r\n") &&
                                          Catch::Contains("\r\nSec-WebSocket-Version: 13\r\n") &&
                                          Catch::Contains("application/problem+json"));
    for (const std::string given : {"", "Sec-WebSocket-Key: short\r\n"})
        CHECK_THAT(ask_open(wants + given + "Sec-WebSocket-Version: 13\r\n\r\n"),
                   Catch::StartsWith("HTTP/1.1 400 ") && Catch::Contains("Sec-WebSocket-Key") &&
                       Catch::Contains("application/problem+json"));
    // On a connection that stays, the field Connection names the upgrade that is offered.
    CHECK_THAT(ask_open(head + "\r\n" + head + close), Catch::Contains("\r\nConnection: Upgrade\r\n"));
}

TEST_CASE("responses to what is no request are counted too", "[http][metrics][R63]") {
    RunningServer server;
    const auto count = [&](const char* route, unsigned status) {
        const auto text = web_request(server.port(), "GET", "/metrics").body;
        const auto line = fmt::format("\naeolis_http_responses_total{{route=\"{}\",status=\"{}\"}} ", route, status);
        const auto at = text.find(line);
        return at == std::string::npos ? 0 : std::stoi(text.substr(at + line.size()));
    };
    for (const char* status : {"401", "429"})  // before the first: an alert's increase() begins there
        CHECK_THAT(web_request(server.port(), "GET", "/metrics").body,
                   Catch::Contains(fmt::format("{{route=\"POST /api/v1/session\",status=\"{}\"}} 0\n", status)));
    const std::string host = "Host: localhost\r\n";
    raw_exchange(server.port(), "this is not HTTP\r\n\r\n");
    raw_exchange(server.port(), "GET /healthz HTTP/1.1\r\n" + host + host + "\r\n");
    raw_exchange(server.port(), "GET ftp://localhost/ HTTP/1.1\r\n" + host + "Connection: close\r\n\r\n");
    CHECK(count("none", 400) == 3);
    raw_exchange(server.port(), "GET / HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'x') + "\r\n\r\n");
    CHECK(count("none", 431) == 1);
    raw_exchange(server.port(), "GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n");
    CHECK(count("none", 403) == 1);
    raw_exchange(server.port(),
                 "POST /api/v1/session HTTP/1.1\r\n" + host + "Content-Length: 2\r\nExpect: tea\r\n\r\n");
    CHECK(count("none", 417) == 1);
    CHECK_FALSE(StreamClient{server.port(), "chat"}.open());
    CHECK(count("GET /api/v1/stream", 400) == 1);
}

TEST_CASE("who is locked out is told for how long, by the status of too many requests", "[http][access][R63]") {
    RunningServer server{RunningServer::WithAccounts{}};
    const std::string body = R"({"user":"administrator","password":"wrong"})";
    const auto log_in = [&] {
        return raw_exchange(server.port(), fmt::format("POST /api/v1/session HTTP/1.1\r\nHost: localhost\r\n"
                                                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
                                                       body.size(), body));
    };
    for (unsigned i = 0; i < server::Access::tries_of_user; ++i)
        CHECK_THAT(log_in(), Catch::StartsWith("HTTP/1.1 401 "));
    CHECK_THAT(log_in(), Catch::StartsWith("HTTP/1.1 429 ") && Catch::Contains("\r\nRetry-After: ") &&
                             Catch::Contains("too many wrong log-ins"));
}

}  // namespace server_http_letter_test
