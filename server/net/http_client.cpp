// SPDX-License-Identifier: Apache-2.0
#include "server/net/http_client.hpp"

#include "server/net/sockets.hpp"
#include "server/net/web_server.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/url/parse.hpp>
#include <fmt/format.h>
#include <optional>

namespace aeolis::server {
namespace {

using namespace net;
namespace http = beast::http;

struct Place {
    bool secure = false;
    std::string host, port, authority;
};

Result<Place> place_of(const std::string& server) {
    const auto url = boost::urls::parse_uri(server);
    const auto refused = Error{fmt::format("--server {}: expected http://HOST:PORT or https://HOST:PORT", server)};
    if (!url || (url->scheme() != "http" && url->scheme() != "https") || url->host().empty() || url->has_userinfo() ||
        url->has_query())
        return refused;
    if (!url->encoded_path().empty() && url->encoded_path() != "/") return refused;
    Place place;
    place.secure = url->scheme() == "https";
    place.host = url->host_address();
    place.port = url->has_port() ? std::string{url->port()} : place.secure ? "443" : "80";
    place.authority = std::string{url->encoded_host_and_port()};
    return place;
}

/// The step that failed; without an error, none.
struct Outcome {
    const char* what = "";
    error_code error;
    bool may_have_arrived = false;  ///< the whole request
};

struct Patience {
    std::chrono::seconds each, answer;
};

/// Sends the request and reads its answer; the first failure is the outcome.
template <typename AnyStream>
Task<Outcome> exchange(AnyStream& stream, http::request<http::string_body>& request,
                       http::response_parser<http::string_body>& parser, Patience patience) {
    auto& lowest = beast::get_lowest_layer(stream);
    Outcome outcome;
    outcome.what = "the request could not be sent";
    lowest.expires_after(patience.each);
    co_await http::async_write(stream, request, asio::redirect_error(awaiting, outcome.error));
    outcome.may_have_arrived = !outcome.error || outcome.error == beast::error::timeout;  // may coincide
    if (outcome.error) co_return outcome;
    outcome.what = "no answer";
    beast::flat_buffer buffer;
    lowest.expires_after(patience.answer);
    co_await http::async_read(stream, buffer, parser, asio::redirect_error(awaiting, outcome.error));
    co_return outcome;
}

Task<Outcome> ask(Place place, asio::ssl::context& tls, http::request<http::string_body>& request,
                  http::response_parser<http::string_body>& parser, Patience patience) {
    Outcome outcome;
    auto executor = co_await asio::this_coro::executor;
    asio::ip::basic_resolver<tcp, Executor> resolver{executor};
    outcome.what = "its address is not found";
    const auto ends =
        co_await resolver.async_resolve(place.host, place.port, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    Stream stream{executor};
    stream.expires_after(patience.each);
    outcome.what = "no connection";
    co_await stream.async_connect(ends, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    if (!place.secure) co_return co_await exchange(stream, request, parser, patience);
    TlsStream secure{std::move(stream), tls};
    secure.set_verify_mode(asio::ssl::verify_peer);
    secure.set_verify_callback(asio::ssl::host_name_verification{place.host});
    SSL_set_tlsext_host_name(secure.native_handle(), place.host.c_str());
    beast::get_lowest_layer(secure).expires_after(patience.each);
    outcome.what = "no safe connection";
    co_await secure.async_handshake(asio::ssl::stream_base::client, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    co_return co_await exchange(secure, request, parser, patience);
}

}  // namespace

Result<HttpClient::Answer> HttpClient::post(const std::string& path, const std::string& json) const {
    const auto place = place_of(settings_.server);
    if (!place) return place.error();
    if (!settings_.token.empty() && !place->secure && !WebServer::is_loopback(place->host))
        return Error{fmt::format(
            "--server {}: over http others could read the token: it is sent over https, or to this machine only",
            settings_.server)};
    asio::ssl::context tls{asio::ssl::context::tls_client};
    SSL_CTX_set_min_proto_version(tls.native_handle(), TLS1_2_VERSION);
    error_code error;
    if (settings_.authorities.empty())
        tls.set_default_verify_paths(error);
    else
        tls.load_verify_file(settings_.authorities.string(), error);
    if (error) return Error{fmt::format("--authorities {}: {}", settings_.authorities.string(), error.message())};
    http::request<http::string_body> request{http::verb::post, boost::beast::string_view{path.data(), path.size()}, 11};
    request.set(http::field::host, place->authority);
    request.set(http::field::content_type, "application/json");
    request.set(http::field::connection, "close");
    if (!settings_.token.empty()) request.set(http::field::authorization, "Bearer " + settings_.token);
    request.body() = json;
    request.prepare_payload();
    http::response_parser<http::string_body> parser;
    parser.body_limit(answer_octets_max);
    asio::io_context io{1};
    std::optional<Outcome> outcome;
    const Patience patience{.each = settings_.patience, .answer = settings_.answer_patience};
    asio::co_spawn(io, ask(*place, tls, request, parser, patience),
                   [&outcome](const std::exception_ptr& broken, Outcome done) {
                       if (!broken) outcome = done;
                   });
    io.run();
    if (!outcome) return Answer{.lost = fmt::format("{}: the request was broken off", settings_.server)};
    const auto why = outcome->error
                         ? fmt::format("{}: {}: {}", settings_.server, outcome->what, outcome->error.message())
                         : std::string{};
    if (outcome->error && !outcome->may_have_arrived) return Error{why};
    if (outcome->error) return Answer{.lost = why};
    return Answer{.status = parser.get().result_int(), .body = std::move(parser.get().body())};
}

}  // namespace aeolis::server
