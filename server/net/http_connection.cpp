// SPDX-License-Identifier: Apache-2.0
#include "server/net/http_connection.hpp"

#include "server/net/request_head.hpp"
#include "server/net/request_origin.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>
#include <optional>
#include <string_view>
#include <utility>

namespace aeolis::server::net {
namespace {

namespace http = beast::http;
namespace websocket = beast::websocket;

using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;
using Parser = http::request_parser<http::string_body>;
using NextPart = decltype(HttpResponse::next_part);

constexpr const char* stream_path = "/api/v1/stream";
constexpr const char* stream_route = "GET /api/v1/stream";
constexpr std::size_t slice_octets = 64 << 10;    // chosen: of a long body sent in parts
constexpr std::size_t websocket_key_octets = 24;  // 16 in base64 [RFC 6455, 4.1]

/// The console loads nothing from elsewhere and must not be shown in a frame.
constexpr const char* security_policy =
    "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'; script-src 'self'; worker-src "
    "'self'; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

struct Subprotocol {
    std::string_view name;
    StreamFormat format;
};
constexpr std::array subprotocols{Subprotocol{"aeolis.v1.protobuf", StreamFormat::protobuf},
                                  Subprotocol{"aeolis.v1.json", StreamFormat::json}};

std::string_view plain(beast::string_view text) {
    return {text.data(), text.size()};
}

/// The value of a header that may be given in several lines.
std::string joined(const Request& request, http::field name) {
    std::string value;
    const auto [begin, end] = request.equal_range(name);
    for (auto line = begin; line != end; ++line)
        value += (value.empty() ? "" : ",") + std::string{plain(line->value())};
    return value;
}

/// The client's first subprotocol that the server supports.
const Subprotocol* chosen_subprotocol(const Request& request) {
    for (const auto token : http::token_list{request[http::field::sec_websocket_protocol]})
        for (const auto& spoken : subprotocols)
            if (plain(token) == spoken.name) return &spoken;
    return nullptr;
}

/// Builds the response, moving the body out of `answer`.
Response response_of(HttpResponse& answer, unsigned version) {
    Response response{static_cast<http::status>(answer.status), version};
    response.set(http::field::content_type, answer.content_type);
    response.set(http::field::cache_control, answer.cache_control);
    for (const auto& [name, value] : answer.fields) response.insert(name, value);
    response.body() = std::move(answer.body);
    return response;
}

Response error_reply(const Request& request, http::status status, const std::string& error) {
    auto answer = error_response(static_cast<unsigned>(status), error);
    auto response = response_of(answer, request.version() == 10 ? 10U : 11U);
    response.prepare_payload();
    return response;
}

/// 503, and the request may be sent again soon.
Response retry_reply(const Request& request, const std::string& error) {
    auto answer = retry_response(503, error, std::chrono::seconds{1});
    auto response = response_of(answer, request.version() == 10 ? 10U : 11U);
    response.prepare_payload();
    return response;
}

/// The response to a request that is not HTTP or too long. @param octets_max  limit of its body
Response broken_reply(const Request& request, const error_code& error, std::size_t octets_max) {
    if (error == http::error::body_limit)
        return error_reply(request, http::status::payload_too_large,
                           fmt::format("the body is longer than {} octets", octets_max));
    if (error == http::error::header_limit && request.target().empty())  // its first line has not ended
        return error_reply(request, http::status::uri_too_long,
                           fmt::format("the target is longer than {} octets", WebServer::header_octets_max));
    if (error == http::error::header_limit)
        return error_reply(request, http::status::request_header_fields_too_large,
                           fmt::format("the header is longer than {} octets", WebServer::header_octets_max));
    return error_reply(request, http::status::bad_request, "this is not HTTP: " + error.message());
}

HttpResponse too_many_answers() {
    return retry_response(503, "too many long answers are under way: try again, or ask for less at once",
                          std::chrono::seconds{1});
}

/// Awaits the value that `ask` passes to its callback, on any thread.
template <typename T, typename Ask>
Task<T> told(asio::io_context& io, Ask ask) {
    return asio::async_initiate<const asio::use_awaitable_t<Executor>, void(T)>(
        [&io](auto done, const Ask& asking) {
            auto shared = std::make_shared<decltype(done)>(std::move(done));
            asking([&io, shared](T answer) {
                asio::post(io,
                           [shared, answer = std::move(answer)]() mutable { std::move (*shared)(std::move(answer)); });
            });
        },
        awaiting, std::move(ask));
}

/// A request and its response.
struct Exchange {
    Credentials credentials;
    Request request;
    std::optional<WaitingPeers::Waiting> waiting;
    Response response;
    std::optional<BodyBudget::Share> share;  ///< for the response's body
    NextPart next_part;                      ///< null: the response is complete
};

/// A client's connection: one request after another.
template <typename AnyStream>
class HttpConnection {
  public:
    HttpConnection(AnyStream& stream, HttpService& service, Peer peer)
        : stream_(stream), lowest_(beast::get_lowest_layer(stream)), service_(service), peer_(std::move(peer)) {}

    Task<> serve();

  private:
    // Each returns false once it has closed the connection or it must be closed.
    Task<bool> read(Exchange& exchange);
    Task<bool> answer(Exchange& exchange);
    Task<bool> write(Exchange& exchange);
    Task<bool> write_whole(Exchange& exchange);
    Task<bool> write_parts(Response first, NextPart next_part);

    Credentials credentials_of(const Request& request) const;
    std::string client_address(const Request& request) const;
    std::string refusal_of_share(const Credentials& credentials);
    std::size_t body_octets_max(const Request& request, const Credentials& credentials) const;
    Task<bool> invite_body(const Parser& parser);
    Task<> answer_broken(const Request& request, error_code error, std::size_t octets_max);
    Task<bool> end_with(Response reply);
    void count(const char* route, const Response& response) const;
    std::string refusal_of(const Request& request, const std::string& host) const;
    std::optional<Response> refusal_of_stream(const Exchange& exchange) const;
    Task<> become_stream(Exchange& exchange);
    Task<> ask(Exchange& exchange, std::string path, std::string query);
    void add_fields(Exchange& exchange) const;
    Task<error_code> write_slice(asio::const_buffer octets, bool chunked);
    bool tear();

    AnyStream& stream_;
    Stream& lowest_;
    HttpService& service_;
    Peer peer_;
    beast::flat_buffer buffer_;
};

template <typename AnyStream>
Task<> HttpConnection<AnyStream>::serve() {
    for (;;) {
        Exchange exchange;
        if (!co_await read(exchange)) co_return;
        if (!co_await answer(exchange)) co_return;
        add_fields(exchange);
        if (!co_await write(exchange)) co_return;
    }
}

/// Reads the next request. Answers requests that break HTTP or a limit.
template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::read(Exchange& exchange) {
    error_code error;
    Parser parser;
    parser.body_limit(HttpRequest::body_octets_max);
    parser.header_limit(WebServer::header_octets_max);
    lowest_.expires_after(service_.request_max);
    co_await http::async_read_header(stream_, buffer_, parser, asio::redirect_error(awaiting, error));
    std::size_t octets_max = HttpRequest::body_octets_max;
    if (!error)
        if (const auto refusal = refusal_of_framing(parser.get()); !refusal.empty())
            co_return co_await end_with(error_reply(parser.get(), http::status::bad_request, refusal));
    exchange.credentials = credentials_of(parser.get());
    if (!error && !parser.is_done()) octets_max = body_octets_max(parser.get(), exchange.credentials);
    if (octets_max < HttpRequest::body_octets_max) {
        parser.body_limit(octets_max);
        if (parser.content_length().value_or(0) > octets_max) error = http::make_error_code(http::error::body_limit);
    }
    if (!error && !parser.is_done() && !co_await invite_body(parser)) co_return false;
    if (!error && !parser.is_done())
        co_await http::async_read(stream_, buffer_, parser, asio::redirect_error(awaiting, error));
    if (error) {
        co_await answer_broken(parser.get(), error, octets_max);
        co_return false;
    }
    exchange.request = parser.release();
    co_return true;
}

template <typename AnyStream>
Credentials HttpConnection<AnyStream>::credentials_of(const Request& request) const {
    return {std::string{plain(request[http::field::cookie])}, std::string{plain(request[http::field::authorization])},
            client_address(request)};
}

template <typename AnyStream>
std::string HttpConnection<AnyStream>::client_address(const Request& request) const {
    std::string passed;
    const auto [first, last] = request.equal_range("X-Forwarded-For");
    for (auto field = first; field != last; ++field)
        passed += (passed.empty() ? "" : ",") + std::string{plain(field->value())};
    return service_.proxies.client(peer_.address, passed);
}

/// Notes who sends this request, the first of somebody known on this connection. Why they have no place; empty: they
/// do.
template <typename AnyStream>
std::string HttpConnection<AnyStream>::refusal_of_share(const Credentials& credentials) {
    if (peer_.place->known()) return {};
    const auto person = service_.handlers.person ? service_.handlers.person(credentials) : std::string{};
    if (!person) return {};
    const auto known = peer_.place->know(*person);
    return known ? "" : known.error().message;
}

/// The body limit, determined before reading: the bodies of a thousand strangers take no memory.
template <typename AnyStream>
std::size_t HttpConnection<AnyStream>::body_octets_max(const Request& request, const Credentials& credentials) const {
    if (!service_.handlers.body_octets) return HttpRequest::body_octets_max;
    const auto target = target_of(request);
    return service_.handlers.body_octets(credentials, plain(request.method_string()), target ? target->path : "");
}

/// Answers Expect: 100-continue (RFC 9110, 10.1.1) of a client whose body has not begun to come.
template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::invite_body(const Parser& parser) {
    const auto& request = parser.get();
    const auto expected = request.find(http::field::expect);
    if (expected == request.end() || request.version() == 10) co_return true;
    if (!beast::iequals(expected->value(), "100-continue"))
        co_return co_await end_with(
            error_reply(request, http::status::expectation_failed, "Expect: only 100-continue is known"));
    if (buffer_.size() > 0) co_return true;
    error_code error;
    constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
    co_await asio::async_write(stream_, asio::buffer(go_on), asio::redirect_error(awaiting, error));
    co_return !error;
}

/// Sends the last response of the connection; false.
template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::end_with(Response reply) {
    count("none", reply);
    reply.keep_alive(false);
    error_code ignored;
    co_await http::async_write(stream_, reply, asio::redirect_error(awaiting, ignored));
    co_return false;
}

/// Counts a response that no handler gave.
template <typename AnyStream>
void HttpConnection<AnyStream>::count(const char* route, const Response& response) const {
    if (service_.handlers.refused) service_.handlers.refused(route, response.result_int());
}

/// Answers only errors within HTTP; a broken or silent connection gets no answer.
template <typename AnyStream>
Task<> HttpConnection<AnyStream>::answer_broken(const Request& request, error_code error, std::size_t octets_max) {
    const bool is_http = error.category() == http::make_error_code(http::error::bad_method).category();
    if (!is_http || error == http::error::end_of_stream) co_return;
    co_await end_with(broken_reply(request, error, octets_max));
}

template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::answer(Exchange& exchange) {
    const auto& request = exchange.request;
    auto target = target_of(request);
    const char* route = "none";
    if (!target) {
        exchange.response = error_reply(request, http::status::bad_request, target.error().message);
    } else if (const auto refusal = refusal_of(request, target->host); !refusal.empty()) {
        exchange.response = error_reply(request, http::status::forbidden, refusal);
    } else if (const auto no_place = refusal_of_share(exchange.credentials); !no_place.empty()) {
        exchange.response = retry_reply(request, no_place);
    } else if (!websocket::is_upgrade(request) || target->path != stream_path) {
        co_await ask(exchange, std::move(target->path), std::move(target->query));
        co_return true;
    } else if (auto refused = refusal_of_stream(exchange)) {
        route = stream_route;
        exchange.response = std::move(*refused);
    } else {
        co_await become_stream(exchange);
        co_return false;
    }
    count(route, exchange.response);
    co_return true;
}

/// Why the request must be answered with 403; empty: accepted.
template <typename AnyStream>
std::string HttpConnection<AnyStream>::refusal_of(const Request& request, const std::string& host) const {
    const auto origin = request.find(http::field::origin);
    const auto given = origin != request.end() ? std::optional{plain(origin->value())} : std::nullopt;
    return refusal_of_origin(host, given, service_.names, service_.secure);
}

/// The response that denies a stream; none: granted.
template <typename AnyStream>
std::optional<Response> HttpConnection<AnyStream>::refusal_of_stream(const Exchange& exchange) const {
    const auto& request = exchange.request;
    auto admitted = service_.handlers.admit_stream(exchange.credentials);
    if (admitted.status != 200) return response_of(admitted, request.version());
    if (plain(request[http::field::sec_websocket_version]) != "13") {
        auto refused = upgrade_response("Sec-WebSocket-Version: 13 is wanted");
        return response_of(refused, request.version());
    }
    if (request[http::field::sec_websocket_key].size() != websocket_key_octets)
        return error_reply(request, http::status::bad_request, "Sec-WebSocket-Key: 16 octets in base64 are wanted");
    if (chosen_subprotocol(request) == nullptr)
        return error_reply(request, http::status::bad_request,
                           "the stream speaks the subprotocols aeolis.v1.protobuf and aeolis.v1.json: offer one");
    if (const auto no_place = service_.streams.refusal(); !no_place.empty()) return retry_reply(request, no_place);
    return std::nullopt;
}

template <typename AnyStream>
Task<> HttpConnection<AnyStream>::become_stream(Exchange& exchange) {
    const auto* subprotocol = chosen_subprotocol(exchange.request);
    StreamService stream_service{service_.scheduler, service_.streams, WebServer::message_octets_max,
                                 service_.silence_max,
                                 [&handlers = service_.handlers,
                                  credentials = exchange.credentials](StreamFormat format, std::function<void()> wake) {
                                     return handlers.open_stream(credentials, format, std::move(wake));
                                 }};
    co_await serve_stream(std::move(stream_), std::move(exchange.request), subprotocol->format, subprotocol->name,
                          std::move(stream_service));
}

/// Passes the request to the rest of the server and waits for its response.
template <typename AnyStream>
Task<> HttpConnection<AnyStream>::ask(Exchange& exchange, std::string path, std::string query) {
    auto& request = exchange.request;
    lowest_.expires_never();
    exchange.waiting.emplace(service_.waiting, lowest_.socket().native_handle());
    // A named variable: g++ 12 destroys temporary aggregates of a co_await twice.
    HttpRequest asked{std::string{plain(request.method_string())},
                      std::move(path),
                      std::move(query),
                      std::move(request.body()),
                      std::move(exchange.credentials),
                      exchange.waiting->disconnected(),
                      joined(request, http::field::accept_encoding)};
    const auto hand_on = [this, &asked](const Respond& respond) {
        service_.handlers.request(std::move(asked), respond);
    };
    auto answered = co_await told<HttpResponse>(service_.io, hand_on);
    if (!service_.answers.has_room(answered.body.size())) answered = too_many_answers();
    exchange.share.emplace(service_.answers, answered.body.size());
    exchange.response = response_of(answered, request.version());
    exchange.next_part = std::move(answered.next_part);
}

/// Adds the header fields common to all responses.
template <typename AnyStream>
void HttpConnection<AnyStream>::add_fields(Exchange& exchange) const {
    auto& response = exchange.response;
    response.set(http::field::server, "aeolis");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Content-Security-Policy", security_policy);
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    if (service_.secure && !is_loopback_host(plain(exchange.request[http::field::host])))
        response.set("Strict-Transport-Security", "max-age=31536000");
    response.keep_alive(exchange.request.keep_alive());
}

template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::write(Exchange& exchange) {
    if (exchange.next_part && exchange.request.method() != http::verb::head)
        return write_parts(std::move(exchange.response), std::move(exchange.next_part));
    return write_whole(exchange);
}

template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::write_whole(Exchange& exchange) {
    auto& response = exchange.response;
    response.prepare_payload();
    if (exchange.request.method() == http::verb::head) response.body().clear();
    if (exchange.next_part) response.erase(http::field::content_length);  // the length is unknown
    http::response_serializer<http::string_body> serializer{response};
    error_code error;
    while (!error && !serializer.is_done()) {
        lowest_.expires_after(service_.request_max);  // a slow client needs only to progress
        co_await http::async_write_some(stream_, serializer, asio::redirect_error(awaiting, error));
    }
    co_return !error && response.keep_alive();
}

/// Writes a body in parts; each is requested once the client has taken the one before.
template <typename AnyStream>
Task<bool> HttpConnection<AnyStream>::write_parts(Response first, NextPart next_part) {
    const bool chunked = first.version() >= 11;  // in HTTP/1.0 the end of the connection ends the body
    if (!chunked) first.keep_alive(false);
    const bool keep = first.keep_alive();
    BodyPart part{std::optional{std::move(first.body())}};
    http::response<http::empty_body> head{std::move(first.base())};
    head.chunked(chunked);
    http::response_serializer<http::empty_body> serializer{head};
    error_code error;
    lowest_.expires_after(service_.request_max);
    co_await http::async_write_header(stream_, serializer, asio::redirect_error(awaiting, error));
    while (!error && part && *part) {
        for (std::string_view rest = **part; !error && !rest.empty();
             rest.remove_prefix(std::min(rest.size(), slice_octets)))
            error = co_await write_slice(asio::buffer(rest.data(), std::min(rest.size(), slice_octets)), chunked);
        lowest_.expires_never();
        if (!error) part = co_await told<BodyPart>(service_.io, next_part);
    }
    if (error || !part) co_return tear();
    if (!chunked) co_return false;
    lowest_.expires_after(service_.request_max);
    const auto end = http::make_chunk_last();
    co_await asio::async_write(stream_, end, asio::redirect_error(awaiting, error));
    co_return keep && !error;
}

template <typename AnyStream>
Task<error_code> HttpConnection<AnyStream>::write_slice(asio::const_buffer octets, bool chunked) {
    error_code error;
    lowest_.expires_after(service_.request_max);  // a slow client needs only to progress
    if (chunked) {
        const auto chunk = http::make_chunk(octets);
        co_await asio::async_write(stream_, chunk, asio::redirect_error(awaiting, error));
    } else {
        co_await asio::async_write(stream_, octets, asio::redirect_error(awaiting, error));
    }
    co_return error;
}

/// Resets the connection: without chunks, an orderly close would look like the end of the body.
template <typename AnyStream>
bool HttpConnection<AnyStream>::tear() {
    error_code ignored;
    lowest_.socket().set_option(asio::socket_base::linger{true, 0}, ignored);
    lowest_.socket().close(ignored);
    return false;
}

}  // namespace

Task<> serve_http(Stream& stream, HttpService& service, Peer peer) {
    HttpConnection<Stream> connection{stream, service, std::move(peer)};
    co_await connection.serve();
}

Task<> serve_http(TlsStream& stream, HttpService& service, Peer peer) {
    HttpConnection<TlsStream> connection{stream, service, std::move(peer)};
    co_await connection.serve();
}

namespace {

template <typename AnyStream>
Task<> refuse(AnyStream& stream, const std::string& reason) {
    auto answer = retry_response(503, reason, std::chrono::seconds{1});
    auto reply = response_of(answer, 11);
    reply.keep_alive(false);
    reply.prepare_payload();
    error_code ignored;
    beast::get_lowest_layer(stream).expires_after(refusal_max);
    co_await http::async_write(stream, reply, asio::redirect_error(awaiting, ignored));
}

}  // namespace

Task<> refuse_connection(Stream& stream, const std::string& reason) {
    co_await refuse(stream, reason);
}

Task<> refuse_connection(TlsStream& stream, const std::string& reason) {
    co_await refuse(stream, reason);
}

}  // namespace aeolis::server::net
