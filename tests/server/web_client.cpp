// SPDX-License-Identifier: Apache-2.0
#include "tests/server/web_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace aeolis::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds patience{
    120};  // a loaded machine with sanitizers is slow: a run can be half a minute in starting

std::string authority(std::uint16_t port) {
    return "127.0.0.1:" + std::to_string(port);
}

/// Runs what was started; a time-out of the stream ends it.
template <typename Start>
error_code finish(asio::io_context& io, Start start) {
    error_code result;
    start([&result](error_code error, auto&&...) { result = error; });
    io.restart();
    io.run();
    return result;
}

}  // namespace

WebReply web_request(std::uint16_t port, std::string_view method, std::string_view target, std::string_view body,
                     const Headers& headers) {
    asio::io_context io;
    beast::tcp_stream stream{io};
    stream.connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), port});
    http::request<http::string_body> request{http::verb::get, {target.data(), target.size()}, 11};
    request.method_string({method.data(), method.size()});
    request.set(http::field::host, authority(port));
    for (const auto& [name, value] : headers) request.set(name, value);
    request.body() = body;
    request.prepare_payload();
    stream.expires_after(patience);
    error_code ignored;
    http::write(stream, request, ignored);  // the server may answer, and close, before it has read all
    http::response_parser<http::string_body> parser;
    parser.body_limit(64 << 20);
    if (method == "HEAD") parser.skip(true);
    beast::flat_buffer buffer;
    const auto error = finish(io, [&](auto done) { http::async_read(stream, buffer, parser, done); });
    if (error) return {};
    const auto& response = parser.get();
    Headers fields;
    for (const auto& each : response) fields.emplace_back(std::string{each.name_string()}, std::string{each.value()});
    const auto text = [&](http::field field) { return std::string{response[field]}; };
    return {response.result_int(),
            text(http::field::content_type),
            text(http::field::cache_control),
            text(http::field::set_cookie),
            std::string{response["Content-Security-Policy"]},
            response.body(),
            std::string{response["Aeolis-Next-After"]},
            std::move(fields)};
}

std::string raw_exchange(std::uint16_t port, std::string_view octets) {
    asio::io_context io;
    beast::tcp_stream stream{io};
    stream.connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), port});
    error_code ignored;
    asio::write(stream.socket(), asio::buffer(octets), ignored);
    stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    std::string answer;
    stream.expires_after(patience);
    finish(io, [&](auto done) { asio::async_read(stream, asio::dynamic_buffer(answer), done); });
    return answer;
}

struct StreamClient::State {
    asio::io_context io;
    beast::websocket::stream<beast::tcp_stream> socket{io};
    beast::websocket::response_type response;
    beast::flat_buffer buffer;
    bool open = false;
};

StreamClient::StreamClient(std::uint16_t port, const std::string& subprotocols, const Headers& headers)
    : state_(std::make_unique<State>()) {
    auto& socket = state_->socket;
    beast::get_lowest_layer(socket).connect(tcp::endpoint{asio::ip::make_address("127.0.0.1"), port});
    socket.set_option(beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
        if (!subprotocols.empty()) request.set(http::field::sec_websocket_protocol, subprotocols);
        for (const auto& [name, value] : headers) request.set(name, value);
    }));
    socket.read_message_max(64 << 20);
    error_code error;
    socket.handshake(state_->response, authority(port), "/api/v1/stream", error);
    state_->open = !error;
}
StreamClient::~StreamClient() = default;
StreamClient::StreamClient(StreamClient&&) noexcept = default;

bool StreamClient::open() const {
    return state_->open;
}
unsigned StreamClient::status() const {
    return state_->response.result_int();
}
std::string StreamClient::subprotocol() const {
    return std::string{state_->response[http::field::sec_websocket_protocol]};
}

void StreamClient::send(std::string_view payload, bool binary) {
    state_->socket.binary(binary);
    error_code ignored;
    state_->socket.write(asio::buffer(payload), ignored);
}

std::optional<std::string> StreamClient::receive() {
    state_->buffer.clear();
    beast::get_lowest_layer(state_->socket).expires_after(patience);
    const auto error = finish(state_->io, [&](auto done) { state_->socket.async_read(state_->buffer, done); });
    if (error) return std::nullopt;
    return beast::buffers_to_string(state_->buffer.data());
}

std::uint16_t StreamClient::close_code() const {
    return state_->socket.reason().code;
}

std::string StreamClient::close_words() const {
    const auto& words = state_->socket.reason().reason;
    return {words.data(), words.size()};
}

}  // namespace aeolis::test
