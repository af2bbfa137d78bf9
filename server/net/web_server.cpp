// SPDX-License-Identifier: Apache-2.0
#include "server/net/web_server.hpp"

#include "aeolis/v1/run.pb.h"
#include "server/access/network.hpp"
#include "server/base/json.hpp"
#include "server/net/connection_count.hpp"
#include "server/net/sockets.hpp"
#include "server/net/stream_connection.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/url/parse.hpp>
#include <deque>
#include <fmt/format.h>
#include <list>
#include <poll.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

using namespace net;
namespace http = beast::http;
namespace websocket = beast::websocket;

using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

constexpr const char* stream_path = "/api/v1/stream";
constexpr std::size_t slice_octets = 64 << 10;  // ours: of a long body in parts, written at once
constexpr std::size_t short_octets =
    512 << 10;  // ours: of an answer that is given however many long ones wait: the console's files, the dictionary
constexpr unsigned peers_looked_at_ms = 250;  // ours: a question goes on for so long after its client has left
struct Subprotocol {
    std::string_view name;
    StreamFormat format;
};
constexpr std::array subprotocols{Subprotocol{"aeolis.v1.protobuf", StreamFormat::protobuf},
                                  Subprotocol{"aeolis.v1.json", StreamFormat::json}};

std::string_view plain(beast::string_view text) {
    return {text.data(), text.size()};
}

/// The console needs nothing from elsewhere, and nobody may show it in a frame.
constexpr const char* security_policy =
    "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'; script-src 'self'; worker-src "
    "'self'; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// Of "name", "name:port", "[::1]:port".
std::string_view host_of(std::string_view authority) {
    const auto bracket = authority.rfind(']');
    const auto colon = authority.rfind(':');
    const bool has_port = colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
    return has_port ? authority.substr(0, colon) : authority;
}

bool is_loopback_name(std::string_view host) {
    return boost::beast::iequals(host, "localhost") || host == "127.0.0.1" || host == "[::1]";
}

/// The first of ours that the client offers.
const Subprotocol* chosen_subprotocol(const Request& request) {
    for (const auto token : http::token_list{request[http::field::sec_websocket_protocol]})
        for (const auto& ours : subprotocols)
            if (plain(token) == ours.name) return &ours;
    return nullptr;
}

Response error_reply(const Request& request, http::status status, const std::string& error) {
    v1::ErrorReply reply;
    reply.set_error(error);
    Response response{status, request.version() == 10 ? 10U : 11U};
    response.set(http::field::content_type, "application/json");
    response.set(http::field::cache_control, "no-store");
    response.body() = to_json(reply);
    response.prepare_payload();
    return response;
}

struct Peer {
    int descriptor = -1;
    std::shared_ptr<std::atomic<bool>> gone;
};

/// Connections whose question is being answered, so that one can stop when its client leaves.
///
/// Looks at all a few times a second, by whether the peer has closed its side: what it sent before, a farewell of TLS
/// too, may lie unread. Over a network that falls silent nothing is seen; the time-out of a question bounds that.
class WaitingPeers {
  public:
    /// One of them, for as long as this lives.
    class Waiting {
      public:
        Waiting(WaitingPeers& all, int descriptor)
            : all_(all), place_(all.waiting_.insert(all.waiting_.end(),
                                                    {descriptor, std::make_shared<std::atomic<bool>>(false)})) {}
        ~Waiting() { all_.waiting_.erase(place_); }
        Waiting(const Waiting&) = delete;
        Waiting& operator=(const Waiting&) = delete;
        /// From any thread, also when this is no more.
        std::function<bool()> gone() const {
            return [gone = place_->gone] { return gone->load(std::memory_order_relaxed); };
        }

      private:
        WaitingPeers& all_;
        std::list<Peer>::iterator place_;
    };
    void look() {
        for (const auto& peer : waiting_) {
            pollfd asked{peer.descriptor, POLLRDHUP, 0};
            if (::poll(&asked, 1, 0) > 0)
                peer.gone->store(true, std::memory_order_relaxed);  // POLLERR and POLLHUP come unasked
        }
    }

  private:
    std::list<Peer> waiting_;
};

/// Bodies that lie in memory until their clients have taken them.
struct OctetsUnderWay {
    std::size_t max = 0, now = 0;

    /// One of them, for as long as this lives.
    class Taken {
      public:
        Taken(OctetsUnderWay& all, std::size_t octets) : all_(all), octets_(octets) { all_.now += octets_; }
        ~Taken() { all_.now -= octets_; }
        Taken(const Taken&) = delete;
        Taken& operator=(const Taken&) = delete;

      private:
        OctetsUnderWay& all_;
        std::size_t octets_;
    };
    bool has_room(std::size_t octets) const { return octets <= short_octets || now == 0 || now + octets <= max; }
};

/// An address of version 4 as such, also when the socket is one of version 6.
asio::ip::address plain_address(const asio::ip::address& address) {
    if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address;
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
}

/// Of certificate and key, or what is wrong with them; none: no TLS.
Result<std::optional<asio::ssl::context>> tls_of(const WebServer::Settings& settings) {
    if (settings.certificate.empty() && settings.key.empty()) return std::optional<asio::ssl::context>{};
    if (settings.certificate.empty() || settings.key.empty())
        return Error{"TLS: --tls-certificate and --tls-key are given together"};
    asio::ssl::context context{asio::ssl::context::tls_server};
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    context.set_password_callback(
        [](std::size_t, asio::ssl::context::password_purpose) { return std::string{}; });  // never asks
    error_code error;
    context.use_certificate_chain_file(settings.certificate.string(), error);
    if (error) return Error{fmt::format("--tls-certificate {}: {}", settings.certificate.string(), error.message())};
    context.use_private_key_file(settings.key.string(), asio::ssl::context::pem, error);
    if (error) return Error{fmt::format("--tls-key {}: {}", settings.key.string(), error.message())};
    return std::optional{std::move(context)};
}

}  // namespace

struct WebServer::State {
    explicit State(const Settings& settings)
        : connections(settings.streams + connections_besides, connections_each_max), streams(settings.streams),
          names(settings.names), request_max(settings.request_max), silence_max(settings.silence_max) {
        answers.max = settings.answers_octets_max;
    }
    // What the coroutines of connections know of; they end with io.
    ConnectionCount connections;
    OpenStreams streams;
    WaitingPeers waiting;
    OctetsUnderWay answers;
    asio::io_context io{1};
    WriteTurn turn{io.get_executor()};
    Acceptor acceptor{io.get_executor()};
    std::optional<asio::ssl::context> tls;
    std::vector<std::string> names;
    std::chrono::milliseconds request_max{}, silence_max{};
    Handlers handlers;
    std::deque<Timer> timers;  ///< of every()
    Timer farewell{io.get_executor()};

    void end();
    Task<> accept();
    Task<> repeat(Timer& timer, std::chrono::milliseconds interval, std::function<void()> action);
    Task<> serve(Socket socket);
    template <typename AnyStream>
    Task<> serve_requests(AnyStream& stream, std::string from);
    template <typename AnyStream>
    Task<bool> write_parts(AnyStream& stream, Response first, decltype(HttpResponse::more) more);
    template <typename T, typename Ask>
    Task<T> told(Ask ask);
    std::string refusal_of(const Request& request) const;
};

/// Empty when the request may go on.
std::string WebServer::State::refusal_of(const Request& request) const {
    const auto host = plain(request[http::field::host]);
    const auto is_this = [&](const std::string& name) { return boost::beast::iequals(name, host_of(host)); };
    if (!is_loopback_name(host_of(host)) && std::ranges::none_of(names, is_this))
        return fmt::format("Host '{}' is not a name of this server: it answers to loopback names{}", host,
                           names.empty() ? " only" : " and to those of --host");
    // Another program's page on this machine is another origin, too: only our own may command. A program that is no
    // browser sends none.
    const auto origin = request.find(http::field::origin);
    const std::string own = fmt::format("{}://{}", tls ? "https" : "http", host);
    if (origin != request.end() && !boost::beast::iequals(plain(origin->value()), own))
        return fmt::format("Origin '{}' is not a page of this server", plain(origin->value()));
    return {};
}

/// What `ask` tells, from whatever thread.
template <typename T, typename Ask>
Task<T> WebServer::State::told(Ask ask) {
    return asio::async_initiate<const asio::use_awaitable_t<Executor>, void(T)>(
        [this](auto done, const Ask& asking) {
            auto shared = std::make_shared<decltype(done)>(std::move(done));
            asking([this, shared](T answer) {
                asio::post(io,
                           [shared, answer = std::move(answer)]() mutable { std::move (*shared)(std::move(answer)); });
            });
        },
        awaiting, std::move(ask));
}

/// A body that comes in parts, each asked for when the client has taken the one before it. False: the connection is
/// over.
template <typename AnyStream>
Task<bool> WebServer::State::write_parts(AnyStream& stream, Response first, decltype(HttpResponse::more) more) {
    auto& lowest = beast::get_lowest_layer(stream);
    const bool chunked = first.version() >= 11;  // before that a body ended with its connection
    if (!chunked) first.keep_alive(false);
    const bool keep = first.keep_alive();
    BodyPart part{std::optional{std::move(first.body())}};
    http::response<http::empty_body> head{std::move(first.base())};
    head.chunked(chunked);
    http::response_serializer<http::empty_body> serializer{head};
    error_code error;
    lowest.expires_after(request_max);
    co_await http::async_write_header(stream, serializer, asio::redirect_error(awaiting, error));
    while (!error && part && *part) {
        for (std::string_view rest = **part; !error && !rest.empty();
             rest.remove_prefix(std::min(rest.size(), slice_octets))) {
            lowest.expires_after(request_max);  // a slow client needs only to go on
            const auto octets = asio::buffer(rest.data(), std::min(rest.size(), slice_octets));
            if (chunked) {
                const auto chunk = http::make_chunk(octets);
                co_await asio::async_write(stream, chunk, asio::redirect_error(awaiting, error));
            } else {
                co_await asio::async_write(stream, octets, asio::redirect_error(awaiting, error));
            }
        }
        lowest.expires_never();
        if (!error) part = co_await told<BodyPart>(more);
    }
    if (error || !part) {  // torn, not ended: without chunks an end would look like the end of the body
        error_code ignored;
        lowest.socket().set_option(asio::socket_base::linger{true, 0}, ignored);
        lowest.socket().close(ignored);
        co_return false;
    }
    if (!chunked) co_return false;
    lowest.expires_after(request_max);
    const auto end = http::make_chunk_last();
    co_await asio::async_write(stream, end, asio::redirect_error(awaiting, error));
    co_return keep && !error;
}

template <typename AnyStream>
Task<> WebServer::State::serve_requests(AnyStream& stream, std::string from) {
    auto& lowest = beast::get_lowest_layer(stream);
    beast::flat_buffer buffer;
    for (;;) {
        error_code error;
        http::request_parser<http::string_body> parser;
        parser.body_limit(HttpRequest::body_octets_max);
        parser.header_limit(header_octets_max);
        lowest.expires_after(request_max);
        co_await http::async_read_header(stream, buffer, parser, asio::redirect_error(awaiting, error));
        // Before anything is read of who has not said who they are: a thousand such bodies are no burden.
        const auto field = [&](http::field name) { return std::string{plain(parser.get()[name])}; };
        Credentials credentials{field(http::field::cookie), field(http::field::authorization), from};
        const auto wanted = plain(parser.get().target());
        const std::size_t octets_max = error || parser.is_done() || !handlers.body_octets
                                           ? HttpRequest::body_octets_max
                                           : handlers.body_octets(credentials, plain(parser.get().method_string()),
                                                                  wanted.substr(0, wanted.find('?')));
        if (!error && octets_max < HttpRequest::body_octets_max) {
            parser.body_limit(octets_max);
            if (parser.content_length().value_or(0) > octets_max)
                error = http::make_error_code(http::error::body_limit);
        }
        if (!error && !parser.is_done())
            co_await http::async_read(stream, buffer, parser, asio::redirect_error(awaiting, error));
        if (error == http::error::end_of_stream || error == beast::error::timeout) co_return;
        if (error) {
            // Only what the peer could have meant gets an answer; a broken connection gets none.
            if (error.category() != http::make_error_code(http::error::bad_method).category()) co_return;
            const bool too_long = error == http::error::body_limit || error == http::error::header_limit;
            auto reply = error_reply(
                parser.get(), too_long ? http::status::payload_too_large : http::status::bad_request,
                error == http::error::body_limit ? fmt::format("the body is longer than {} octets", octets_max)
                : error == http::error::header_limit
                    ? fmt::format("the header is longer than {} octets", header_octets_max)
                    : "this is not HTTP: " + error.message());
            reply.keep_alive(false);
            co_await http::async_write(stream, reply, asio::redirect_error(awaiting, error));
            co_return;
        }
        auto request = parser.release();
        Response response;
        std::optional<WaitingPeers::Waiting> waiting_here;
        std::optional<OctetsUnderWay::Taken> taken;
        decltype(HttpResponse::more) more;
        const auto target = boost::urls::parse_origin_form(request.target());
        if (const auto refusal = refusal_of(request); !refusal.empty()) {
            response = error_reply(request, http::status::forbidden, refusal);
        } else if (!target) {
            response = error_reply(request, http::status::bad_request, "the request's target is not a path");
        } else if (websocket::is_upgrade(request) && target->path() == stream_path) {
            auto admitted = handlers.admit_stream(credentials);
            const auto* subprotocol = chosen_subprotocol(request);
            const auto no_place = streams.refusal();
            if (admitted.status == 200 && subprotocol != nullptr && no_place.empty()) {
                StreamService service{turn, streams, message_octets_max, silence_max,
                                      [this, credentials](StreamFormat format, std::function<void()> wake) {
                                          return handlers.open_stream(credentials, format, std::move(wake));
                                      }};
                co_await serve_stream(std::move(stream), std::move(request), subprotocol->format, subprotocol->name,
                                      std::move(service));
                co_return;
            }
            if (admitted.status != 200) {
                response = Response{static_cast<http::status>(admitted.status), request.version()};
                response.set(http::field::content_type, admitted.content_type);
                response.body() = std::move(admitted.body);
            } else if (subprotocol == nullptr) {
                response =
                    error_reply(request, http::status::bad_request,
                                "the stream speaks the subprotocols aeolis.v1.protobuf and aeolis.v1.json: offer one");
            } else {
                response = error_reply(request, http::status::service_unavailable, no_place);
            }
        } else {
            lowest.expires_never();
            waiting_here.emplace(waiting, lowest.socket().native_handle());
            // Named, not made in the call: g++ 12 destroys temporary aggregates of a co_await twice.
            HttpRequest asked{std::string{plain(request.method_string())},
                              target->path(),
                              std::string{target->encoded_query()},
                              std::move(request.body()),
                              std::move(credentials),
                              waiting_here->gone()};
            const auto ask = [this, &asked](const Respond& respond) { handlers.request(std::move(asked), respond); };
            auto answered = co_await told<HttpResponse>(ask);
            if (!answers.has_room(answered.body.size())) {
                answered = {};
                answered.status = 503;
                v1::ErrorReply reply;
                reply.set_error("too many long answers are under way: try again, or ask for less at once");
                answered.body = to_json(reply);
            }
            taken.emplace(answers, answered.body.size());
            response = Response{static_cast<http::status>(answered.status), request.version()};
            response.set(http::field::content_type, answered.content_type);
            response.set(http::field::cache_control, answered.cache_control);
            if (!answered.set_cookie.empty()) response.set(http::field::set_cookie, answered.set_cookie);
            if (!answered.next_after.empty()) response.set("Aeolis-Next-After", answered.next_after);
            response.body() = std::move(answered.body);
            more = std::move(answered.more);
        }
        response.set(http::field::server, "aeolis");
        response.set("X-Content-Type-Options", "nosniff");
        response.set("Content-Security-Policy", security_policy);
        response.set("Referrer-Policy", "no-referrer");
        response.set("Cross-Origin-Opener-Policy", "same-origin");
        if (tls && !is_loopback_name(host_of(plain(request[http::field::host]))))
            response.set("Strict-Transport-Security", "max-age=31536000");
        response.keep_alive(request.keep_alive());
        if (more && request.method() != http::verb::head) {
            if (!co_await write_parts(stream, std::move(response), std::move(more))) co_return;
            continue;
        }
        response.prepare_payload();
        if (request.method() == http::verb::head) response.body().clear();
        if (more) response.erase(http::field::content_length);  // nobody knows it
        http::response_serializer<http::string_body> serializer{response};
        while (!error && !serializer.is_done()) {
            lowest.expires_after(request_max);  // a slow client needs only to go on
            co_await http::async_write_some(stream, serializer, asio::redirect_error(awaiting, error));
        }
        if (error || !response.keep_alive()) co_return;
    }
}

Task<> WebServer::State::serve(Socket socket) {
    error_code ignored;
    const auto peer = plain_address(socket.remote_endpoint(ignored).address());
    const std::string from = ignored ? "unknown" : peer.to_string();
    const std::string share = network_of(from);
    const std::string refused = connections.enter(share, peer.is_loopback());
    const std::shared_ptr<void> counted{nullptr, [this, &share, entered = refused.empty()](void*) {
                                            if (entered) connections.leave(share);
                                        }};
    socket.set_option(tcp::no_delay{true}, ignored);
    Stream stream{std::move(socket)};
    if (!refused.empty()) {
        auto reply = error_reply({}, http::status::service_unavailable, refused);
        reply.keep_alive(false);
        stream.expires_after(std::chrono::seconds{1});
        co_await http::async_write(stream, reply, asio::redirect_error(awaiting, ignored));
        co_return;
    }
    if (!tls) {
        co_await serve_requests(stream, from);
        if (stream.socket().is_open()) stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
        co_return;
    }
    TlsStream secure{std::move(stream), *tls};
    auto& lowest = beast::get_lowest_layer(secure);
    lowest.expires_after(request_max);
    error_code error;
    co_await secure.async_handshake(asio::ssl::stream_base::server, asio::redirect_error(awaiting, error));
    if (error) co_return;  // it speaks no TLS, or does not trust us
    co_await serve_requests(secure, from);
    if (!lowest.socket().is_open()) co_return;
    lowest.expires_after(std::chrono::seconds{1});
    co_await secure.async_shutdown(asio::redirect_error(awaiting, error));
}

void WebServer::State::end() {
    error_code ignored;
    acceptor.close(ignored);
    farewell.expires_after(farewell_max);
    farewell.async_wait([this](error_code asked_again) {
        if (asked_again) return;
        streams.forget();  // who does not answer goes with io
        io.stop();
    });
    streams.end([this] { io.stop(); });
}

Task<> WebServer::State::accept() {
    while (acceptor.is_open()) {
        error_code error;
        auto socket = co_await acceptor.async_accept(asio::redirect_error(awaiting, error));
        if (!error) {
            asio::co_spawn(io, serve(std::move(socket)), [](const std::exception_ptr& broken) {
                // A bug in one request: that connection ends, the server goes on.
                try {
                    if (broken) std::rethrow_exception(broken);
                } catch (const std::exception& bug) {
                    spdlog::error("connection closed: {}", bug.what());
                }
            });
            continue;
        }
        if (error == asio::error::operation_aborted) co_return;
        spdlog::warn("a connection could not be accepted: {}", error.message());
        Timer pause{io, std::chrono::milliseconds{100}};  // out of file numbers: do not spin
        co_await pause.async_wait(asio::redirect_error(awaiting, error));
    }
}

Task<> WebServer::State::repeat(Timer& timer, std::chrono::milliseconds interval, std::function<void()> action) {
    error_code error;
    while (!error) {
        timer.expires_after(interval);
        co_await timer.async_wait(asio::redirect_error(awaiting, error));
        if (!error) action();
    }
}

Result<std::unique_ptr<WebServer>> WebServer::open(const Settings& settings, Handlers handlers) {
    error_code error;
    const auto& address = settings.address;
    const auto port = settings.port;
    const auto ip = asio::ip::make_address(address == "localhost" ? "127.0.0.1" : address, error);
    if (error) return Error{fmt::format("--listen {}: not an IP address", address)};
    auto tls = tls_of(settings);
    if (!tls) return tls.error();
    auto state = std::make_unique<State>(settings);
    state->tls = std::move(*tls);
    state->handlers = std::move(handlers);
    const tcp::endpoint endpoint{ip, port};
    auto& acceptor = state->acceptor;
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address{true}, error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use)
        return Error{fmt::format("--listen {}:{}: the port is in use; choose another, or end the program that has it",
                                 address, port)};
    if (error) return Error{fmt::format("--listen {}:{}: {}", address, port, error.message())};
    asio::co_spawn(state->io, state->accept(), asio::detached);
    auto server = std::unique_ptr<WebServer>{new WebServer{std::move(state)}};
    server->every(peers_looked_at_ms, [waiting = &server->state_->waiting] { waiting->look(); });
    return server;
}

bool WebServer::is_loopback(const std::string& address) {
    error_code error;
    const auto ip = asio::ip::make_address(address, error);
    return address == "localhost" || (!error && ip.is_loopback());
}

WebServer::WebServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const {
    return state_->acceptor.local_endpoint().port();
}
void WebServer::run() {
    state_->io.run();
}
void WebServer::stop() {
    asio::post(state_->io, [state = state_.get()] { state->end(); });
}
void WebServer::post(std::function<void()> action) {
    asio::post(state_->io, std::move(action));
}
bool WebServer::secure() const {
    return state_->tls.has_value();
}
std::size_t WebServer::connections() const {
    return state_->connections.all();
}

void WebServer::every(unsigned milliseconds, std::function<void()> action) {
    auto& timer = state_->timers.emplace_back(state_->io.get_executor());
    asio::co_spawn(state_->io, state_->repeat(timer, std::chrono::milliseconds{milliseconds}, std::move(action)),
                   asio::detached);
}

}  // namespace aeolis::server
