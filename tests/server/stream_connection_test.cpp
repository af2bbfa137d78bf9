// SPDX-License-Identifier: Apache-2.0
// Frames on the wire when a client is slow: ours, and the WebSocket's own between them.

#include "tests/server/event_server.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slept_time.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <optional>
#include <sys/resource.h>
#include <sys/socket.h>
#include <thread>

namespace server_stream_connection_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace std::chrono_literals;

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

std::string text_of(archive::Sequence seq, std::size_t octets) {
    return std::string(octets, static_cast<char>('a' + seq % 26));
}

/// `count` events in one turn, each with a text of so many octets.
void publish(EventServer& events, std::size_t octets, std::size_t count = 1) {
    std::vector<std::string> texts;
    for (std::size_t i = 1; i <= count; ++i) texts.push_back(text_of(events.last_seq() + i, octets));
    events.publish(texts);
}

struct Client {
    asio::io_context io;
    websocket::stream<beast::tcp_stream> socket{io};
    beast::flat_buffer buffer;
    std::vector<std::string> pongs;

    explicit Client(std::uint16_t port) {
        auto& tcp = beast::get_lowest_layer(socket);
        tcp.connect(asio::ip::tcp::endpoint{asio::ip::make_address("127.0.0.1"), port});
        socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
            request.set(beast::http::field::sec_websocket_protocol, "aeolis.v1.protobuf");
        }));
        socket.handshake("localhost", "/api/v1/stream");
        socket.binary(true);
        socket.read_message_max(0);
        socket.control_callback([this](websocket::frame_type kind, beast::string_view text) {
            if (kind == websocket::frame_type::pong) pongs.emplace_back(text);
        });
        v1::ClientMessage message;
        message.mutable_subscribe()->set_all_channels(true);
        socket.write(asio::buffer(message.SerializeAsString()));
    }
    v1::ServerMessage read() {
        buffer.clear();
        socket.read(buffer);
        v1::ServerMessage message;
        REQUIRE(message.ParseFromArray(buffer.data().data(), static_cast<int>(buffer.size())));
        return message;
    }
};

}  // namespace

TEST_CASE("a client that stalls and pings gets every frame whole, and each pong between two of them", "[stream]") {
    EventServer events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    // Frames of every length of header, until the kernel takes no more by far.
    constexpr std::size_t rounds = 60, octets[] = {20, 300, 70'000, 200'000};
    for (std::size_t i = 0; i < rounds; ++i) {
        for (const auto size : octets) publish(events, size);
        if (i % 20 == 0) client.socket.ping(websocket::ping_data{fmt::format("ping {}", i)});
        std::this_thread::sleep_for(2ms);
    }
    archive::Sequence last = 0;
    while (last < rounds * std::size(octets)) {
        const auto message = client.read();
        for (const auto& item : message.batch().items()) {
            REQUIRE(item.seq() == ++last);
            REQUIRE(item.event().text() == text_of(last, octets[(last - 1) % std::size(octets)]));
        }
    }
    // Its pongs came meanwhile or come now; Beast answers the newest ping when several wait.
    client.socket.ping("last");
    publish(events, 1);
    publish(events, 1);
    for (int i = 0; i < 20 && (client.pongs.empty() || client.pongs.back() != "last"); ++i) {
        client.read();
        publish(events, 1);
    }
    REQUIRE_FALSE(client.pongs.empty());
    CHECK(client.pongs.front() == "ping 0");
    CHECK(client.pongs.back() == "last");
}

TEST_CASE("a client that closes gets its close, and nothing after it", "[stream]") {
    EventServer events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    for (int i = 0; i < 200; ++i) publish(events, 1000);
    beast::error_code error;
    client.socket.close(websocket::close_code::normal, error);  // reads what was under way, up to the answer
    CHECK_FALSE(error);
}

TEST_CASE("batches that are published in one turn of the network go out in one message", "[stream]") {
    EventServer events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    publish(events, 10, 8);
    const auto message = client.read();
    CHECK(message.batch().items_size() == 8);
    CHECK(message.batch().complete_through() == 8);
}

namespace {

const std::string upgrade =
    "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
    "Sec-WebSocket-Protocol: aeolis.v1.protobuf\r\n\r\n";

/// A peer that was let in and then says nothing any more, as when its cable is pulled.
struct Dead {
    asio::io_context io;
    asio::ip::tcp::socket socket{io};

    explicit Dead(std::uint16_t port) {
        socket.connect({asio::ip::make_address("127.0.0.1"), port});
        asio::write(socket, asio::buffer(upgrade));
        v1::ClientMessage message;
        message.mutable_subscribe()->set_all_channels(true);
        const auto payload = message.SerializeAsString();
        const auto frame =
            std::string{'\x82'} + static_cast<char>(0x80U | payload.size()) + std::string(4, '\0') + payload;
        asio::write(socket, asio::buffer(frame));
    }
};

}  // namespace

TEST_CASE("a peer that answers no ping is let go, also while the kernel takes nothing more for it, and one that "
          "answers stays",
          "[stream][bounds]") {
    server::WebServer::Settings settings;
    settings.silence_max = 600ms;
    EventServer events{settings};
    Client alive{events.port()};
    REQUIRE(alive.read().has_welcome());
    std::size_t heard = 0;
    std::thread reads{[&] {  // to read is to answer
        beast::flat_buffer buffer;
        for (beast::error_code error; !error;) {
            buffer.clear();
            alive.socket.read(buffer, error);
            heard += error ? 0 : 1;
        }
    }};
    const auto comes_to = [&](std::size_t count) {
        for (int i = 0; i < 3000 && events.clients() != count; ++i) std::this_thread::sleep_for(10ms);
        return events.clients() == count;
    };
    {
        const Dead idle{events.port()};
        CHECK(comes_to(2));
        CHECK(comes_to(1));
    }
    {
        const Dead choked{events.port()};
        CHECK(comes_to(2));
        for (int i = 0; i < 64; ++i) publish(events, 1 << 18);  // far more than the kernel keeps of a connection
        CHECK(comes_to(1));
    }
    std::this_thread::sleep_for(2 * settings.silence_max);
    CHECK(events.clients() == 1);
    ::shutdown(beast::get_lowest_layer(alive.socket).socket().native_handle(), SHUT_RDWR);
    reads.join();
    CHECK(heard > 0);
}

TEST_CASE("of what a client does not read little is with the kernel: the rest waits where it can be thinned",
          "[stream][bounds]") {
    EventServer events;
    asio::io_context io;
    websocket::stream<beast::tcp_stream> socket{io};
    auto& tcp = beast::get_lowest_layer(socket);
    tcp.socket().open(asio::ip::tcp::v4());
    tcp.socket().set_option(asio::socket_base::receive_buffer_size{64 << 10});
    tcp.socket().connect({asio::ip::make_address("127.0.0.1"), events.port()});
    socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
        request.set(beast::http::field::sec_websocket_protocol, "aeolis.v1.protobuf");
    }));
    socket.handshake("localhost", "/api/v1/stream");
    socket.binary(true);
    v1::ClientMessage message;
    message.mutable_subscribe()->set_all_channels(true);
    socket.write(asio::buffer(message.SerializeAsString()));
    for (int i = 0; i < 160; ++i) {  // 8 MB, of which a kernel takes some four where it may
        publish(events, 512, 100);
        std::this_thread::sleep_for(2ms);
    }
    CHECK(events.octets_given() > 50'000);
    CHECK(events.octets_given() < 1'000'000);
}

TEST_CASE("when the server ends, each stream is closed as going away, with the reason", "[stream]") {
    EventServer events;
    std::vector<StreamClient> clients;
    for (int i = 0; i < 3; ++i) {
        clients.emplace_back(events.port(), i == 0 ? "aeolis.v1.json" : "aeolis.v1.protobuf");
        REQUIRE(clients.back().open());
    }
    publish(events, 20);
    std::chrono::milliseconds took{};
    std::thread ends{[&] {
        const tests::SleptTime time;
        events.end();
        took = time.passed();
    }};
    std::vector<std::thread> readers;  // to read is to answer
    for (auto& client : clients)
        readers.emplace_back([&client] {
            while (client.receive()) {
            }
        });
    for (auto& reader : readers) reader.join();
    ends.join();
    for (const auto& client : clients) {
        CHECK(client.close_code() == 1001);
        CHECK(client.close_words() == "the server ends");
    }
    CHECK(took < server::WebServer::close_timeout);  // it does not wait longer than for the last of them
}

TEST_CASE("a server that ends waits a second at most for streams that do not answer", "[stream][bounds]") {
    EventServer events;
    const Dead idle{events.port()}, choked{events.port()};
    for (int i = 0; i < 3000 && events.clients() != 2; ++i) std::this_thread::sleep_for(10ms);
    REQUIRE(events.clients() == 2);
    for (int i = 0; i < 64; ++i) publish(events, 1 << 18);
    const auto begun = std::chrono::steady_clock::now();
    const tests::SleptTime time;
    events.end();
    CHECK(std::chrono::steady_clock::now() - begun >= server::WebServer::close_timeout);
    CHECK(time.passed() < 2 * server::WebServer::close_timeout);
}

TEST_CASE("one stream more than there are places is refused with 503, and who has none is answered",
          "[stream][http][bounds]") {
    server::WebServer::Settings settings;
    settings.streams = 2;
    EventServer events{settings};
    const auto answers = [&] { return web_request(events.port(), "GET", "/healthz").status == 200; };
    const StreamClient first{events.port(), "aeolis.v1.json"};
    std::optional<StreamClient> second{std::in_place, events.port(), "aeolis.v1.json"};
    REQUIRE(first.open());
    REQUIRE(second->open());
    CHECK(StreamClient{events.port(), "aeolis.v1.json"}.status() == 503);
    CHECK_THAT(raw_exchange(events.port(), upgrade),
               Catch::Contains("2 streams are open already") && Catch::Contains("\r\nRetry-After: 1\r\n"));
    CHECK(answers());
    second.reset();
    for (int i = 0; i < 3000 && events.clients() != 1; ++i) std::this_thread::sleep_for(10ms);
    second.emplace(events.port(), "aeolis.v1.json");
    CHECK(second->open());

    asio::io_context io;
    std::vector<asio::ip::tcp::socket> silent;  // twice as many as there are places: none of them keeps one
    for (std::size_t i = 0; i < 2 * server::WebServer::connections_besides; ++i)
        silent.emplace_back(io).connect({asio::ip::make_address("127.0.0.1"), events.port()});
    CHECK(answers());
    const std::string request = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    std::vector<asio::ip::tcp::socket> known;  // each has asked something, and holds its place
    for (std::size_t i = 0; i < server::WebServer::connections_besides; ++i) {
        known.emplace_back(io).connect({asio::ip::make_address("127.0.0.1"), events.port()});
        asio::write(known.back(), asio::buffer(request));
        std::string answer;
        asio::read_until(known.back(), asio::dynamic_buffer(answer), "\r\n\r\n");
    }
    CHECK_THAT(raw_exchange(events.port(), request), Catch::Contains("66 connections are open already"));
}

TEST_CASE("while as many streams are open as may be, who has none is answered", "[stream][http][bounds]") {
    rlimit files{};  // the server's sockets and the clients' are in one process
    ::getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
    EventServer events;
    asio::io_context io;
    std::vector<asio::ip::tcp::socket> streams;
    for (std::size_t i = 0; i < server::WebServer::streams_max; ++i) {
        streams.emplace_back(io).connect({asio::ip::make_address("127.0.0.1"), events.port()});
        asio::write(streams.back(), asio::buffer(upgrade));
    }
    for (int i = 0; i < 2'000 && events.clients() != streams.size(); ++i) std::this_thread::sleep_for(10ms);
    REQUIRE(events.clients() == 1'000);
    CHECK(StreamClient{events.port(), "aeolis.v1.json"}.status() == 503);
    CHECK(web_request(events.port(), "GET", "/healthz").status == 200);
}

}  // namespace server_stream_connection_test
