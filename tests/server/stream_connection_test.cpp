// Frames on the wire when a client is slow: ours, and the WebSocket's own between them.

#include "server/net/web_server.hpp"
#include "tests/support/catch.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <thread>

using namespace aeolis;
using namespace std::chrono_literals;

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

/// A stream of events without an archive.
class Events {
  public:
    Events() {
        server::StreamHub::Services services;
        services.want_items = [](bool) {};
        hub_ = std::make_unique<server::StreamHub>(std::uint16_t{1}, services);
        v1::RunState state;
        state.set_run(1);
        hub_->run_state(state);
        server::WebServer::Handlers handlers;
        handlers.admit_stream = [](const server::Credentials&) { return server::HttpResponse{}; };
        handlers.open_stream = [this](const server::Credentials&, server::StreamFormat format, std::function<void()> wake) {
            return std::make_shared<server::StreamSession>(*hub_, format, std::move(wake), server::StreamSession::follower());
        };
        server_ = std::move(server::WebServer::open({}, handlers)).value();
        network_ = std::thread{[this] { server_->run(); }};
    }
    ~Events() {
        server_->stop();
        network_.join();
        server_.reset();
    }
    std::uint16_t port() const { return server_->port(); }
    /// `count` batches in one turn, each an event with a text of so many octets.
    void publish(std::size_t octets, std::size_t count = 1) {
        std::vector<std::shared_ptr<const pipeline::PublishedBatch>> batches;
        for (std::size_t i = 0; i < count; ++i) {
            auto batch = std::make_shared<pipeline::PublishedBatch>();
            batch->run = archive::RunId{1};
            batch->first_seq = batch->last_seq = ++seq_;
            v1::Item item;
            item.set_seq(seq_);
            item.mutable_event()->set_text(std::string(octets, static_cast<char>('a' + seq_ % 26)));
            batch->items = {item};
            batches.push_back(std::move(batch));
        }
        server_->post([this, batches] {
            for (const auto& batch : batches)
                hub_->published(batch);
        });
    }

  private:
    std::unique_ptr<server::StreamHub> hub_;
    std::unique_ptr<server::WebServer> server_;
    std::thread network_;
    archive::Sequence seq_ = 0;
};

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

} // namespace

TEST_CASE("a client that stalls and pings gets every frame whole, and each pong between two of them", "[stream]") {
    Events events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    // Frames of every length of header, until the kernel takes no more by far.
    constexpr std::size_t rounds = 60, octets[] = {20, 300, 70'000, 200'000};
    for (std::size_t i = 0; i < rounds; ++i) {
        for (const auto size : octets)
            events.publish(size);
        if (i % 20 == 0) client.socket.ping(websocket::ping_data{fmt::format("ping {}", i)});
        std::this_thread::sleep_for(2ms);
    }
    archive::Sequence last = 0;
    while (last < rounds * std::size(octets)) {
        const auto message = client.read();
        for (const auto& item : message.batch().items()) {
            REQUIRE(item.seq() == ++last);
            const auto& text = item.event().text();
            REQUIRE(text == std::string(octets[(last - 1) % std::size(octets)], static_cast<char>('a' + last % 26)));
        }
    }
    // Its pongs came meanwhile or come now; Beast answers the newest ping when several wait.
    client.socket.ping("last");
    events.publish(1);
    events.publish(1);
    for (int i = 0; i < 20 && (client.pongs.empty() || client.pongs.back() != "last"); ++i) {
        client.read();
        events.publish(1);
    }
    REQUIRE_FALSE(client.pongs.empty());
    CHECK(client.pongs.front() == "ping 0");
    CHECK(client.pongs.back() == "last");
}

TEST_CASE("a client that closes gets its close, and nothing after it", "[stream]") {
    Events events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    for (int i = 0; i < 200; ++i)
        events.publish(1000);
    beast::error_code error;
    client.socket.close(websocket::close_code::normal, error); // reads what was under way, up to the answer
    CHECK_FALSE(error);
}

TEST_CASE("batches that are published in one turn of the network go out in one message", "[stream]") {
    Events events;
    Client client{events.port()};
    REQUIRE(client.read().has_welcome());
    events.publish(10, 8);
    const auto message = client.read();
    CHECK(message.batch().items_size() == 8);
    CHECK(message.batch().complete_through() == 8);
}
