// SPDX-License-Identifier: Apache-2.0
#include "server/net/web_server.hpp"

#include "server/access/network.hpp"
#include "server/net/connection_count.hpp"
#include "server/net/http_connection.hpp"
#include "server/net/sockets.hpp"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <deque>
#include <fmt/format.h>
#include <optional>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

namespace aeolis::server {
namespace {

using namespace net;

constexpr std::size_t refusing_max = 16;  // chosen: handshakes for connections that are then refused
constexpr unsigned peers_poll_ms = 250;   // chosen: longest work on an answer after its client left

/// Maps an IPv4 address on an IPv6 socket to plain IPv4.
asio::ip::address plain_address(const asio::ip::address& address) {
    if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address;
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
}

ConnectionCount::Limits limits_of(const WebServer::Settings& settings) {
    const auto all = settings.streams + WebServer::connections_besides;
    return {all, std::max(WebServer::connections_besides, all / WebServer::strangers_part),
            WebServer::strangers_each_max};
}

/// The TLS context from certificate and key, or an Error; none: no TLS.
Result<std::optional<asio::ssl::context>> tls_of(const WebServer::Settings& settings) {
    if (settings.certificate.empty() && settings.key.empty()) return std::optional<asio::ssl::context>{};
    if (settings.certificate.empty() || settings.key.empty())
        return Error{"TLS: --tls-certificate and --tls-key are given together"};
    asio::ssl::context context{asio::ssl::context::tls_server};
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    context.set_password_callback(
        [](std::size_t, asio::ssl::context::password_purpose) { return std::string{}; });  // never prompts
    error_code error;
    context.use_certificate_chain_file(settings.certificate.string(), error);
    if (error) return Error{fmt::format("--tls-certificate {}: {}", settings.certificate.string(), error.message())};
    context.use_private_key_file(settings.key.string(), asio::ssl::context::pem, error);
    if (error) return Error{fmt::format("--tls-key {}: {}", settings.key.string(), error.message())};
    return std::optional{std::move(context)};
}

}  // namespace

struct WebServer::State {
    explicit State(const Settings& given) : settings(given), connections(limits_of(given)), service(given) {}

    const Settings settings;
    ConnectionCount connections;
    HttpService service;
    asio::io_context& io = service.io;
    Acceptor acceptor{io.get_executor()};
    std::optional<asio::ssl::context> tls;
    std::deque<Timer> timers;  ///< for every()
    Timer close_timer{io.get_executor()};

    void end();
    Task<> accept();
    Task<> repeat(Timer& timer, std::chrono::milliseconds interval, std::function<void()> action);
    Task<> serve(Socket socket);
    Task<> serve_plain(Stream stream, Peer peer);
    Task<> serve_tls(Stream stream, Peer peer, const std::string& refused);
    std::size_t refusing = 0;  ///< connections beyond the limit that are being told so over TLS
};

Task<> WebServer::State::serve(Socket socket) {
    error_code ignored;
    const auto address = plain_address(socket.remote_endpoint(ignored).address());
    const std::string from = ignored ? "unknown" : address.to_string();
    const auto close = [descriptor = socket.native_handle()] { ::shutdown(descriptor, SHUT_RDWR); };
    const bool shared = address.is_loopback() || service.proxies.contains(from);
    const auto place = connections.enter(network_of(from), shared, close);
    const std::string refused = place ? "" : place.error().message;
    socket.set_option(tcp::no_delay{true}, ignored);
    Stream stream{std::move(socket)};
    Peer peer{from, place ? *place : nullptr};
    if (!refused.empty() && service.handlers.refused) service.handlers.refused("none", 503);
    if (tls)
        co_await serve_tls(std::move(stream), std::move(peer), refused);
    else if (!refused.empty())
        co_await refuse_connection(stream, refused);
    else
        co_await serve_plain(std::move(stream), std::move(peer));
}

Task<> WebServer::State::serve_plain(Stream stream, Peer peer) {
    co_await serve_http(stream, service, std::move(peer));
    error_code ignored;
    if (stream.socket().is_open()) stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
}

/// @param refused  why the connection is refused, which the client is told inside TLS; empty: it is served
Task<> WebServer::State::serve_tls(Stream stream, Peer peer, const std::string& refused) {
    if (!refused.empty() && refusing >= refusing_max) co_return;  // handshakes cost: a flood gets none
    const std::shared_ptr<void> counted{nullptr, [this, counts = !refused.empty()](void*) { refusing -= counts; }};
    refusing += !refused.empty();
    TlsStream secure{std::move(stream), *tls};
    auto& lowest = beast::get_lowest_layer(secure);
    lowest.expires_after(refused.empty() ? service.request_max : std::chrono::milliseconds{refusal_max});
    error_code error;
    co_await secure.async_handshake(asio::ssl::stream_base::server, asio::redirect_error(awaiting, error));
    if (error) co_return;  // the client speaks no TLS, or rejects the certificate
    if (refused.empty())
        co_await serve_http(secure, service, std::move(peer));
    else
        co_await refuse_connection(secure, refused);
    if (!lowest.socket().is_open()) co_return;
    lowest.expires_after(std::chrono::seconds{1});
    co_await secure.async_shutdown(asio::redirect_error(awaiting, error));
}

void WebServer::State::end() {
    error_code ignored;
    acceptor.close(ignored);
    close_timer.expires_after(close_timeout);
    close_timer.async_wait([this](error_code asked_again) {
        if (asked_again) return;
        service.streams.forget();  // io stops without the remaining clients
        io.stop();
    });
    service.streams.end([this] { io.stop(); });
}

Task<> WebServer::State::accept() {
    while (acceptor.is_open()) {
        error_code error;
        auto socket = co_await acceptor.async_accept(asio::redirect_error(awaiting, error));
        if (!error) {
            asio::co_spawn(io, serve(std::move(socket)), [](const std::exception_ptr& broken) {
                // A bug in one request closes that connection only.
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
        Timer pause{io, std::chrono::milliseconds{100}};  // out of file descriptors: do not spin
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
    auto proxies = TrustedProxies::parse(settings.trusted_proxies);
    if (!proxies) return proxies.error();
    auto state = std::make_unique<State>(settings);
    state->service.proxies = std::move(*proxies);
    state->tls = std::move(*tls);
    state->service.secure = state->tls.has_value();
    state->service.handlers = std::move(handlers);
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
    server->every(peers_poll_ms, [waiting = &server->state_->service.waiting] { waiting->poll_peers(); });
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
    return state_->service.secure;
}
Result<void> WebServer::renew_certificate() {
    auto tls = tls_of(state_->settings);
    if (!tls) return tls.error();
    state_->tls = std::move(*tls);
    return {};
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
