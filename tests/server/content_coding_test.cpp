// SPDX-License-Identifier: Apache-2.0
#include "server/api/content_coding.hpp"

#include "server/net/web_server.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include <fstream>
#include <memory>
#include <thread>
#include <zlib.h>

namespace server_content_coding_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

/// What gzip makes of it; empty when it is not whole.
std::string inflated(std::string_view octets) {
    z_stream stream{};
    REQUIRE(inflateInit2(&stream, 15 + 16) == Z_OK);
    std::string input{octets}, text(64 << 20, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    const int done = inflate(&stream, Z_FINISH);
    text.resize(done == Z_STREAM_END && stream.avail_in == 0 ? stream.total_out : 0);
    inflateEnd(&stream);
    return text;
}

std::string field(const WebReply& reply, std::string_view name) {
    std::string value;
    for (const auto& [known, text] : reply.fields)
        if (known == name) value += (value.empty() ? "" : ", ") + text;
    return value;
}

server::HttpResponse text_response(std::string body, const char* type = "application/json") {
    server::HttpResponse response;
    response.content_type = type;
    response.body = std::move(body);
    return response;
}

struct Case {
    const char* header;
    bool gzip;
    bool identity = true;
};

}  // namespace

TEST_CASE("gzip is chosen by Accept-Encoding as RFC 9110, 12.5.3, has it", "[http][R62]") {
    const std::vector<Case> cases{
        {"", false},
        {"gzip", true},
        {"x-gzip", true},
        {"GZip", true},
        {"gzip, deflate, br", true},
        {"deflate, br", false},
        {"gzip;q=0", false},
        {"gzip; q=0.0", false},
        {"gzip;q=0.001", true},
        {"gzip ; Q=1.000", true},
        {"*", true},
        {"*;q=0.5", true},
        {"gzip;q=0, *", false},
        {"*;q=0, gzip", true, false},
        {"*;q=0", false, false},
        {"identity", false},
        {"identity;q=0", false, false},
        {"identity;q=0, gzip;q=0.1", true, false},
        {"identity;q=0.5, gzip;q=0.5", true},
        {"identity, gzip;q=0.5", false},
        {"identity;q=0.5, *;q=0.2", false},
        {"gzip;q=2", false},
        {"gzip;q=", false},
        {"gzip;q=-1", false},
        {"gzip;q=0.5;q=0", false},
        {"gzipped", false},
        {",, ,gzip,", true},
        {";q=1", false},
    };
    for (const auto& [header, gzip, identity] : cases) {
        INFO(header);
        const auto accepted = server::accepted_codings(header);
        CHECK(accepted.gzip == gzip);
        CHECK(accepted.identity == identity);
    }
}

TEST_CASE("only a text of a kibibyte or more is compressed, and what depends on the header says so", "[http]") {
    const server::AcceptedCodings gzip{true, true};
    const std::string long_text(4'096, 'x');
    auto response = text_response(long_text);
    encode(response, gzip);
    CHECK(response.field("Content-Encoding") == "gzip");
    CHECK(response.field("Vary") == "Accept-Encoding");
    CHECK(response.body.size() < 100);
    CHECK(inflated(response.body) == long_text);

    response = text_response(long_text);
    encode(response, {});
    CHECK(response.field("Content-Encoding").empty());
    CHECK(response.field("Vary") == "Accept-Encoding");
    CHECK(response.body == long_text);

    for (auto plain : {text_response(std::string(server::coded_octets_min - 1, 'x')),
                       text_response(long_text, "font/woff2"), server::error_response(404, long_text)}) {
        const auto body = plain.body;
        encode(plain, gzip);
        CHECK(plain.fields.empty());
        CHECK(plain.body == body);
    }
    auto brief = text_response("{}");
    encode(brief, {true, false});  // the text as it is is refused
    CHECK(inflated(brief.body) == "{}");
}

TEST_CASE("a body in parts is compressed part by part, and a part that fails ends it", "[http]") {
    const auto body_of = [](std::vector<server::BodyPart> parts) {
        auto response = text_response("begin ");
        response.next_part = [parts = std::move(parts), next = std::size_t{0}](const auto& tell) mutable {
            tell(next < parts.size() ? parts[next++] : server::BodyPart{std::optional<std::string>{}});
        };
        encode(response, {true, true});
        return response;
    };
    std::string noise;
    for (unsigned i = 0; i < 300'000; ++i) noise += static_cast<char>(i * 2654435761U >> 24U);
    auto response = body_of({std::optional{noise}, std::optional{std::string{}}, std::optional<std::string>{"end"}});
    std::string octets = response.body;
    for (bool ended = false; !ended;)
        response.next_part([&](const server::BodyPart& part) {
            REQUIRE(part);
            ended = !*part;
            octets += part->value_or("");
        });
    CHECK(inflated(octets) == "begin " + noise + "end");

    auto broken = body_of({Error{"the disk is gone"}});
    broken.next_part([&](const server::BodyPart& part) { CHECK(part.error().message == "the disk is gone"); });
}

TEST_CASE("over a socket a compressed answer has its own length, HEAD tells the same, and a part at a time is whole",
          "[http][R62]") {
    const std::string text(100'000, 'x');
    server::WebServer::Handlers handlers;
    handlers.request = [&](const server::HttpRequest& request, const server::Respond& respond_with) {
        auto response = text_response(text, "text/csv; charset=utf-8");
        if (request.path == "/parts")
            response.next_part = [&text, left = std::make_shared<int>(3)](const auto& tell) {
                tell((*left)-- > 0 ? std::optional{text} : std::optional<std::string>{});
            };
        in_accepted_coding(request, respond_with)(std::move(response));
    };
    auto server = server::WebServer::open({}, std::move(handlers));
    REQUIRE(server);
    std::thread network{[&] { (*server)->run(); }};
    const auto port = (*server)->port();
    const auto plain = web_request(port, "GET", "/");
    CHECK(plain.body == text);
    CHECK(field(plain, "Content-Encoding").empty());
    CHECK(field(plain, "Vary") == "Accept-Encoding");

    const Headers asked{{"Accept-Encoding", "gzip, deflate"}};
    const auto coded = web_request(port, "GET", "/", {}, asked);
    CHECK(field(coded, "Content-Encoding") == "gzip");
    CHECK(field(coded, "Content-Length") == std::to_string(coded.body.size()));
    CHECK(coded.content_type == "text/csv; charset=utf-8");
    CHECK(inflated(coded.body) == text);
    const auto head = web_request(port, "HEAD", "/", {}, asked);
    CHECK(head.body.empty());
    for (const auto* name : {"Content-Encoding", "Content-Length", "Vary", "Content-Type"})
        CHECK(field(head, name) == field(coded, name));

    const auto parts = web_request(port, "GET", "/parts", {}, asked);
    CHECK(field(parts, "Transfer-Encoding") == "chunked");
    CHECK(inflated(parts.body) == text + text + text + text);
    CHECK(web_request(port, "GET", "/parts").body == text + text + text + text);
    CHECK(field(web_request(port, "HEAD", "/parts", {}, asked), "Content-Encoding") == "gzip");

    const auto two_lines =
        raw_exchange(port, "GET / HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: br\r\nAccept-Encoding: gzip\r\n"
                           "Connection: close\r\n\r\n");
    CHECK_THAT(two_lines, Catch::Contains("Content-Encoding: gzip\r\n"));
    (*server)->stop();
    network.join();
}

TEST_CASE("the API and the files of the console come compressed to who asks for it", "[http][R62]") {
    RunningServer server;
    std::filesystem::create_directories(server.archive().parent_path() / "web/assets");
    const std::string script(5'000, ';');
    std::ofstream{server.archive().parent_path() / "web/index.html"} << "<!doctype html>";
    std::ofstream{server.archive().parent_path() / "web/assets/a-1234.js"} << script;
    const Headers gzip{{"Accept-Encoding", "gzip"}};
    for (const auto* target : {"/api/v1/dictionary", "/api/v1/openapi.yaml", "/assets/a-1234.js"}) {
        INFO(target);
        const auto plain = web_request(server.port(), "GET", target);
        const auto coded = web_request(server.port(), "GET", target, {}, gzip);
        CHECK(field(coded, "Content-Encoding") == "gzip");
        CHECK(field(plain, "Vary") == "Accept-Encoding");
        CHECK(coded.body.size() < plain.body.size() / 2);
        CHECK(inflated(coded.body) == plain.body);
        CHECK(coded.cache_control == plain.cache_control);
    }
    CHECK(field(web_request(server.port(), "GET", "/api/v1/session", {}, gzip), "Content-Encoding").empty());
}

}  // namespace server_content_coding_test
