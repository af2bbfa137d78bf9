// SPDX-License-Identifier: Apache-2.0
#include "server/net/http_client.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/certificate.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <fmt/format.h>
#include <fstream>
#include <future>

namespace server_tls_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using error_code = boost::system::error_code;
using tcp = asio::ip::tcp;

struct SecureClient {
    asio::io_context io;
    asio::ssl::context context{asio::ssl::context::tls_client};
    explicit SecureClient(const std::filesystem::path& trusted) {
        context.load_verify_file(trusted.string());
        context.set_verify_mode(asio::ssl::verify_peer);
        context.set_verify_callback(asio::ssl::host_name_verification{"localhost"});
    }
    beast::ssl_stream<beast::tcp_stream> connect(std::uint16_t port) {
        beast::ssl_stream<beast::tcp_stream> stream{io, context};
        beast::get_lowest_layer(stream).connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), port});
        stream.handshake(asio::ssl::stream_base::client);
        return stream;
    }
};

}  // namespace

TEST_CASE("the program's own client speaks only to a server whose certificate is of its name and of a known authority",
          "[access][http]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    write_certificate(folder / "other.pem", folder / "other_key.pem");
    RunningServer server{RunningServer::Secure{folder / "cert.pem", folder / "key.pem"}};
    const auto post = [&](const std::string& scheme, const std::string& host,
                          const std::filesystem::path& authorities) {
        const server::HttpClient client{{.server = fmt::format("{}://{}:{}", scheme, host, server.port()),
                                         .token = "none",
                                         .authorities = authorities}};
        const auto answer = client.post("/api/v1/runs/latest/sequences", "{}");
        if (!answer) return answer.error().message;
        return answer->lost.empty() ? fmt::format("{} {}", answer->status, answer->body)
                                    : "perhaps sent: " + answer->lost;
    };
    CHECK_THAT(post("https", "localhost", folder / "cert.pem"),
               Catch::StartsWith("401 ") && Catch::Contains("log in first"));
    CHECK_THAT(post("https", "127.0.0.1", folder / "cert.pem"), Catch::Contains("no safe connection"));
    CHECK_THAT(post("https", "localhost", folder / "other.pem"), Catch::Contains("no safe connection"));
    CHECK_THAT(post("https", "localhost", {}), Catch::Contains("no safe connection"));
    CHECK_THAT(post("https", "localhost", folder / "no.pem"), Catch::Contains("--authorities"));
    CHECK_THAT(post("http", "localhost", {}), Catch::StartsWith("perhaps sent: ") && Catch::Contains("no answer"));
}

TEST_CASE("the program's own client gets an answer of any length in parts, by TLS, as long as it wants it",
          "[access][http]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    RunningServer server{RunningServer::Secure{folder / "cert.pem", folder / "key.pem"}};
    const server::HttpClient client{{.server = fmt::format("https://localhost:{}", server.port()),
                                     .token = "none",
                                     .authorities = folder / "cert.pem"}};
    std::string body;
    std::size_t parts = 0;
    const auto take = [&](std::string_view part) {
        body += part;
        ++parts;
        return true;
    };
    const auto goes_on = [] { return false; };
    const auto whole = client.get("/api/v1/openapi.yaml", take, goes_on);
    REQUIRE(whole);
    CHECK(whole->status == 200);
    CHECK(whole->lost.empty());
    CHECK(whole->body.empty());
    CHECK_THAT(body.substr(0, 200), Catch::Contains("\nopenapi: 3"));
    CHECK(body.size() > 64'000);
    CHECK(parts > 1);
    const auto broken_off = client.get("/api/v1/openapi.yaml", [](std::string_view) { return false; }, goes_on);
    REQUIRE(broken_off);
    CHECK_FALSE(broken_off->lost.empty());
    const auto stopped = client.get("/api/v1/openapi.yaml", take, [] { return true; });
    REQUIRE(stopped);
    CHECK(stopped->lost == "the request was broken off");
    body.clear();
    const auto refused = client.get("/api/v1/runs/latest/rows", take, goes_on);
    REQUIRE(refused);
    CHECK(refused->status == 401);
    CHECK_THAT(refused->body, Catch::Contains("log in first"));
    CHECK(body.empty());
    server.end();
    const auto away = client.get("/api/v1/openapi.yaml", take, goes_on);
    REQUIRE_FALSE(away);
    CHECK_THAT(away.error().message, Catch::StartsWith("no connection: "));
}

TEST_CASE("what is wrong with a server's address, token or authorities is told before anything is sent", "[http]") {
    const auto fault = [](server::HttpClient::Settings settings) {
        settings.server_option = "--snapshot-from";
        settings.authorities_option = "--snapshot-ca";
        const auto usable = server::HttpClient{std::move(settings)}.check();
        return usable ? std::string{} : usable.error().message;
    };
    CHECK(fault({.server = "https://origin.example:8443", .token = "a secret"}).empty());
    CHECK(fault({.server = "http://origin.example:8080"}).empty());
    CHECK_THAT(fault({.server = "http://origin.example:8080", .token = "a secret"}),
               Catch::StartsWith("--snapshot-from http://origin.example:8080: ") && !Catch::Contains("a secret"));
    CHECK_THAT(fault({.server = "origin.example"}), Catch::StartsWith("--snapshot-from origin.example: expected http"));
    CHECK_THAT(fault({.server = "https://origin.example", .authorities = "/nowhere.pem"}),
               Catch::StartsWith("--snapshot-ca /nowhere.pem: "));
}

TEST_CASE("over http the program's own client gives a token to this machine only", "[access][http]") {
    const auto error_of = [](const std::string& host) {
        const server::HttpClient client{{.server = "http://" + host + ":1", .token = "a secret"}};
        const auto answer = client.post("/", "{}");
        INFO(host);
        REQUIRE_FALSE(answer);  // nobody listens there
        return answer.error().message;
    };
    for (const char* host : {"192.0.2.1", "station.example", "localhost.example", "[2001:db8::1]"})
        CHECK_THAT(error_of(host), Catch::StartsWith(std::string{"--server http://"} + host) &&
                                       Catch::Contains("others could read the token"));
    for (const char* host : {"127.0.0.1", "127.1.2.3", "localhost", "[::1]"})
        CHECK_THAT(error_of(host), !Catch::Contains("others could read the token"));
}

TEST_CASE("a request that has gone and gets no answer is told apart from one that has not gone", "[http]") {
    asio::io_context io;
    tcp::acceptor silent{
        io, tcp::endpoint{asio::ip::make_address("127.0.0.1"), 0}};  // the system takes connections and octets for it
    const std::string silent_one = fmt::format("http://127.0.0.1:{}", silent.local_endpoint().port());
    const server::HttpClient client{{.server = silent_one, .answer_patience = std::chrono::seconds{1}}};
    const auto late = client.post("/", "{}");
    REQUIRE(late);
    CHECK(late->status == 0);
    CHECK_THAT(late->lost, Catch::Contains("no answer"));
    silent.close();
    CHECK_FALSE(client.post("/", "{}"));
}

TEST_CASE("with a certificate the server speaks TLS only: routes, cookies and stream", "[access][http][stream]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    RunningServer server{RunningServer::Secure{folder / "cert.pem", folder / "key.pem"}};
    SecureClient client{folder / "cert.pem"};
    const auto host = "localhost:" + std::to_string(server.port());

    auto stream = client.connect(server.port());
    http::request<http::string_body> request{http::verb::post, "/api/v1/session", 11};
    request.set(http::field::host, host);
    request.set(http::field::origin, "https://" + host);
    request.body() = R"({"user":"administrator","password":")" + server.first_password() + "\"}";
    request.prepare_payload();
    http::write(stream, request);
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    CHECK(response.result_int() == 201);
    const std::string cookie{response[http::field::set_cookie]};
    CHECK_THAT(cookie, Catch::StartsWith("__Host-aeolis_session=") && Catch::Contains("; Secure"));

    request.set(http::field::origin, "http://" + host);  // a page that was not loaded over TLS
    http::write(stream, request);
    response = {};
    http::read(stream, buffer, response);
    CHECK(response.result_int() == 403);

    beast::websocket::stream<beast::ssl_stream<beast::tcp_stream>> socket{client.connect(server.port())};
    socket.set_option(beast::websocket::stream_base::decorator([&](beast::websocket::request_type& upgrade) {
        upgrade.set(http::field::sec_websocket_protocol, "aeolis.v1.json");
    }));
    boost::system::error_code error;
    beast::websocket::response_type refused;
    socket.handshake(refused, host, "/api/v1/stream", error);
    CHECK(refused.result_int() == 401);

    asio::io_context plain;
    beast::tcp_stream bare{plain};
    bare.connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), server.port()});
    http::write(bare, request, error);
    response = {};
    http::read(bare, buffer, response, error);
    CHECK(error);
}

TEST_CASE("a renewed certificate counts for new connections, and one that cannot be read leaves the old one",
          "[access][http]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    RunningServer server{RunningServer::Secure{folder / "cert.pem", folder / "key.pem"}};
    std::filesystem::copy_file(folder / "cert.pem", folder / "old.pem");
    const auto trusts = [&](const std::filesystem::path& trusted) {
        SecureClient client{trusted};
        beast::ssl_stream<beast::tcp_stream> stream{client.io, client.context};
        beast::get_lowest_layer(stream).connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), server.port()});
        error_code error;
        stream.handshake(asio::ssl::stream_base::client, error);
        return !error;
    };
    SecureClient client{folder / "old.pem"};
    auto open_all_along = client.connect(server.port());
    std::ofstream{folder / "cert.pem"} << "not a certificate";
    server.renew_certificate();
    CHECK(trusts(folder / "old.pem"));
    write_certificate(folder / "cert.pem", folder / "key.pem");
    server.renew_certificate();
    for (int i = 0; i < 1000 && !trusts(folder / "cert.pem"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    CHECK(trusts(folder / "cert.pem"));
    CHECK_FALSE(trusts(folder / "old.pem"));
    http::request<http::string_body> request{http::verb::get, "/healthz", 11};
    request.set(http::field::host, "localhost");
    http::write(open_all_along, request);
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(open_all_along, buffer, response);
    CHECK(response.result_int() == 200);
}

TEST_CASE("a connection beyond the limit is refused inside TLS", "[access][http][bounds]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    server::WebServer::Settings settings;
    settings.certificate = folder / "cert.pem";
    settings.key = folder / "key.pem";
    settings.streams = 0;
    server::WebServer::Handlers handlers;
    handlers.request = [](const server::HttpRequest&, const server::Respond& respond) { respond({}); };
    const auto server = std::move(server::WebServer::open(settings, handlers)).value();
    std::thread network{[&] { server->run(); }};

    SecureClient client{folder / "cert.pem"};
    http::request<http::string_body> request{http::verb::get, "/", 11};
    request.set(http::field::host, "localhost");
    std::vector<beast::ssl_stream<beast::tcp_stream>> known;  // each has asked something, and holds its place
    for (std::size_t i = 0; i < server::WebServer::connections_besides; ++i) {
        known.push_back(client.connect(server->port()));
        http::write(known.back(), request);
        beast::flat_buffer buffer;
        http::response<http::string_body> response;
        http::read(known.back(), buffer, response);
    }
    auto stream = client.connect(server->port());
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    CHECK(response.result_int() == 503);
    CHECK_THAT(response.body(), Catch::Contains("connections are open already"));
    server->stop();
    network.join();
}

TEST_CASE("over TLS, too, a client that leaves is noticed while its question is answered", "[access][http][bounds]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    std::promise<std::pair<std::function<bool()>, server::Respond>> asked;
    server::WebServer::Handlers handlers;
    handlers.request = [&](const server::HttpRequest& request, const server::Respond& respond) {
        asked.set_value({request.disconnected, respond});
    };
    server::WebServer::Settings settings;
    settings.certificate = folder / "cert.pem";
    settings.key = folder / "key.pem";
    const auto server = std::move(server::WebServer::open(settings, handlers)).value();
    std::thread network{[&] { server->run(); }};

    SecureClient client{folder / "cert.pem"};
    auto stream = std::make_unique<beast::ssl_stream<beast::tcp_stream>>(client.connect(server->port()));
    http::request<http::string_body> request{http::verb::get, "/", 11};
    request.set(http::field::host, "localhost");
    http::write(*stream, request);
    const auto [gone, respond] = asked.get_future().get();
    CHECK_FALSE(gone());
    error_code ignored;
    stream->next_layer().socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream.reset();
    for (int i = 0; i < 3000 && !gone(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds{10});
    CHECK(gone());
    respond({});
    server->stop();
    network.join();
}

TEST_CASE("a certificate or key that cannot serve is named", "[access][http]") {
    const TemporaryFolder folder;
    write_certificate(folder / "cert.pem", folder / "key.pem");
    write_certificate(folder / "other.pem", folder / "other-key.pem");
    const auto refused = [&](const char* certificate, const char* key) {
        server::ConsoleBackend::Settings settings;
        settings.web_server.certificate = certificate[0] == '\0' ? std::filesystem::path{} : folder / certificate;
        settings.web_server.key = key[0] == '\0' ? std::filesystem::path{} : folder / key;
        settings.archive = folder / "a.db";
        return server::ConsoleBackend::open(settings, tests::shipped_dictionary()).error().message;
    };
    CHECK_THAT(refused("cert.pem", ""), Catch::Contains("given together"));
    CHECK_THAT(refused("none.pem", "key.pem"), Catch::Contains("none.pem"));
    CHECK_THAT(refused("key.pem", "key.pem"), Catch::Contains("--tls-certificate"));
    CHECK_THAT(refused("cert.pem", "cert.pem"), Catch::Contains("--tls-key"));
    CHECK_THAT(refused("cert.pem", "other-key.pem"), Catch::Contains("other-key.pem: key values mismatch"));
    server::ConsoleBackend::Settings open_to_all;
    open_to_all.web_server = {
        .address = "0.0.0.0", .port = 0, .names = {}, .certificate = folder / "cert.pem", .key = folder / "key.pem"};
    open_to_all.accounts = folder / "accounts.json";
    open_to_all.archive = folder / "a.db";
    CHECK_THAT(server::ConsoleBackend::open(open_to_all, tests::shipped_dictionary()).error().message,
               Catch::Contains("--host"));
}

}  // namespace server_tls_test
