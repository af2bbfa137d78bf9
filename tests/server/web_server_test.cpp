// SPDX-License-Identifier: Apache-2.0
// Connections without what is said over them: bodies in parts, and clients that leave.

#include "server/net/web_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <thread>
#include <utility>

namespace server_web_server_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace std::chrono_literals;
using server::WebServer;

namespace {

/// A server whose answers a test gives.
struct Connections {
    std::unique_ptr<WebServer> server;
    std::thread network;

    explicit Connections(std::function<void(server::HttpRequest, server::Respond)> request,
                         const WebServer::Settings& settings = {}) {
        WebServer::Handlers handlers;
        handlers.request = std::move(request);
        server = std::move(WebServer::open(settings, std::move(handlers))).value();
        network = std::thread{[this] { server->run(); }};
    }
    ~Connections() {
        server->stop();
        network.join();
    }
};

/// `count` parts, of `octets` each; an Error in the place of the one `broken`.
server::HttpResponse in_parts(std::size_t count, std::size_t octets, std::atomic<std::size_t>& asked,
                              std::size_t broken = SIZE_MAX) {
    server::HttpResponse response;
    response.body = "begin ";
    response.next_part = [=, &asked](const std::function<void(server::BodyPart)>& tell) {
        const auto i = asked++;
        if (i == broken) return tell(Error{"the disk is gone"});
        tell(i < count ? std::optional{std::string(octets, static_cast<char>('a' + i % 26))} : std::nullopt);
    };
    return response;
}

/// Whether the connection is torn, and not ended.
bool broke_off(std::uint16_t port, const std::string& request) {
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket client{io};
    client.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    boost::asio::write(client, boost::asio::buffer(request));
    std::string answer;
    boost::system::error_code error;
    boost::asio::read(client, boost::asio::dynamic_buffer(answer), error);
    return error == boost::asio::error::connection_reset;
}

bool soon(const std::function<bool()>& what) {
    for (int i = 0; i < 3000 && !what(); ++i) std::this_thread::sleep_for(10ms);
    return what();
}

}  // namespace

TEST_CASE("a body in parts comes whole, and the connection goes on", "[http]") {
    std::atomic<std::size_t> asked{0};
    const Connections here{[&](const server::HttpRequest& request, const server::Respond& respond) {
        respond(request.path == "/long" ? in_parts(3, 100'000, asked) : server::HttpResponse{});
    }};
    const auto reply = web_request(here.server->port(), "GET", "/long");
    CHECK(reply.status == 200);
    CHECK(reply.body == "begin " + std::string(100'000, 'a') + std::string(100'000, 'b') + std::string(100'000, 'c'));

    asked = 0;
    const auto both = raw_exchange(here.server->port(), "GET /long HTTP/1.1\r\nHost: localhost\r\n\r\nGET /short "
                                                        "HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    CHECK_THAT(both, Catch::Contains("Transfer-Encoding: chunked") && Catch::Contains("\r\n0\r\n\r\nHTTP/1.1 200"));
    asked = 0;
    const auto old = raw_exchange(here.server->port(), "GET /long HTTP/1.0\r\nHost: localhost\r\n\r\n");
    CHECK_THAT(old, !Catch::Contains("chunked") && Catch::Contains("\r\n\r\nbegin aaa") && Catch::EndsWith("ccc"));
    asked = 0;
    const auto head =
        raw_exchange(here.server->port(), "HEAD /long HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    CHECK_THAT(head,
               Catch::StartsWith("HTTP/1.1 200") && Catch::EndsWith("\r\n\r\n") && !Catch::Contains("Content-Length"));
    CHECK(asked == 0);
}

TEST_CASE("a body of which a part cannot be had breaks off, so that nobody takes it for whole", "[http]") {
    std::atomic<std::size_t> asked{0};
    const Connections here{
        [&](const server::HttpRequest&, const server::Respond& respond) { respond(in_parts(3, 1000, asked, 2)); }};
    CHECK(web_request(here.server->port(), "GET", "/").status == 0);
    asked = 0;
    const auto octets = raw_exchange(here.server->port(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK_THAT(octets, !Catch::Contains("\r\n0\r\n\r\n"));
    asked = 0;
    CHECK(broke_off(here.server->port(),
                    "GET / HTTP/1.0\r\nHost: localhost\r\n\r\n"));  // where an end is the end of the body
}

TEST_CASE("a client that does not read is asked for no more than its connection holds", "[http][bounds]") {
    std::atomic<std::size_t> asked{0};
    const Connections here{[&](const server::HttpRequest&, const server::Respond& respond) {
        respond(in_parts(100'000, 1 << 20, asked));
    }};
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket client{io};
    client.connect({boost::asio::ip::make_address("127.0.0.1"), here.server->port()});
    const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
    boost::asio::write(client, boost::asio::buffer(request));
    REQUIRE(soon([&] { return asked > 0; }));
    std::size_t before = 0;
    REQUIRE(soon([&] {  // it stands still
        std::this_thread::sleep_for(100ms);
        return std::exchange(before, asked.load()) == asked;
    }));
    CHECK(asked < 64);  // what the kernel keeps of a connection is some megabytes
    CHECK(web_request(here.server->port(), "HEAD", "/").status == 200);  // others are served
}

TEST_CASE("who asks and leaves is noticed, so that the question can stop", "[http][bounds]") {
    std::function<bool()> gone;
    server::Respond answer;
    std::atomic<bool> asked{false};
    const Connections here{[&](const server::HttpRequest& request, const server::Respond& respond) {
        gone = request.disconnected;
        answer = respond;
        asked = true;
    }};
    boost::asio::io_context io;
    auto client = std::make_unique<boost::asio::ip::tcp::socket>(io);
    client->connect({boost::asio::ip::make_address("127.0.0.1"), here.server->port()});
    const std::string request =
        "GET / HTTP/1.1\r\nHost: localhost\r\n\r\nGET / HT";  // what else it sends does not matter
    boost::asio::write(*client, boost::asio::buffer(request));
    REQUIRE(soon([&] { return asked.load(); }));
    std::this_thread::sleep_for(600ms);
    CHECK_FALSE(gone());
    client.reset();
    CHECK(soon(gone));
    std::exchange(answer, {})({});  // nothing of the server outlives it
}

namespace {

/// Octets, as many as the path says.
void as_many_as_asked(const server::HttpRequest& request, const server::Respond& respond) {
    server::HttpResponse response;
    response.body.assign(std::stoul(request.path.substr(1)), 'x');
    respond(std::move(response));
}

/// A client that asks, and takes of the answer what a test tells it to.
struct SlowReader {
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket socket{io};

    SlowReader(std::uint16_t port, const std::string& path) {
        socket.open(boost::asio::ip::tcp::v4());
        socket.set_option(boost::asio::socket_base::receive_buffer_size{256 << 10});  // that the kernel keeps little
        socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
        const auto request = fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", path);
        boost::asio::write(socket, boost::asio::buffer(request));
    }
    /// @return what came; less at the end
    std::size_t take(std::size_t octets) {
        std::string taken(octets, '\0');
        boost::system::error_code error;
        return boost::asio::read(socket, boost::asio::buffer(taken), error);
    }
};

}  // namespace

TEST_CASE("answers that clients do not take have a limit in all, and beyond it only short ones are given",
          "[http][bounds]") {
    constexpr std::size_t long_octets = 16 << 20;
    WebServer::Settings settings;
    settings.answers_octets_max = 3 * long_octets - 1;
    std::atomic<unsigned> given{0};
    const Connections here{[&](const server::HttpRequest& request, const server::Respond& respond) {
                               as_many_as_asked(request, respond);
                               ++given;
                           },
                           settings};
    const auto long_answer = fmt::format("/{}", long_octets);
    const auto port = here.server->port();
    {
        SlowReader first{port, long_answer}, second{port, long_answer};
        REQUIRE(soon([&] { return given == 2; }));
        const auto refused = web_request(port, "GET", long_answer);
        CHECK(refused.status == 503);
        CHECK_THAT(refused.body, Catch::Contains("too many long answers are under way"));
        CHECK(web_request(port, "GET", "/400000").status == 200);  // as long as the console's script, and longer
        CHECK(first.take(long_octets) == long_octets);
    }
    CHECK(soon([&] {
        return web_request(port, "GET", long_answer).status == 200;
    }));  // one was taken, the other's client left
    settings.answers_octets_max = 1;
    const Connections narrow{as_many_as_asked, settings};
    CHECK(web_request(narrow.server->port(), "GET", long_answer).body.size() ==
          long_octets);  // alone it is given, however long
}

TEST_CASE("a client that takes a long answer slowly gets all of it, and one that takes nothing is let go",
          "[http][bounds]") {
    constexpr std::size_t octets = 32 << 20;
    WebServer::Settings settings;
    settings.request_max = 1500ms;  // so long that a busy machine does not let this reader stand still
    const Connections here{as_many_as_asked, settings};
    const auto path = fmt::format("/{}", octets);
    SlowReader slow{here.server->port(), path}, still{here.server->port(), path};
    std::size_t taken = 0;
    const auto begun = std::chrono::steady_clock::now();
    for (int i = 0; i < 12; ++i) {  // three times as long as a client may stand still
        taken += slow.take(octets / 16);
        std::this_thread::sleep_for(400ms);
    }
    CHECK(std::chrono::steady_clock::now() - begun > 3 * settings.request_max);
    taken += slow.take(octets);
    CHECK(taken > octets);  // and its header
    CHECK(still.take(2 * octets) < octets);
}

}  // namespace server_web_server_test
