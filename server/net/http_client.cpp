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
#include <string_view>
#include <vector>

namespace aeolis::server {
namespace {

using namespace net;
namespace http = beast::http;

struct Place {
    bool secure = false;
    std::string host, port, authority;
};

/// Where a server is; the Error: its URL is none, or the token must not go there.
Result<Place> place_of(const HttpClient::Settings& settings) {
    const auto& server = settings.server;
    const auto url = boost::urls::parse_uri(server);
    const auto refused =
        Error{fmt::format("{} {}: expected http://HOST:PORT or https://HOST:PORT", settings.server_option, server)};
    if (!url || (url->scheme() != "http" && url->scheme() != "https") || url->host().empty() || url->has_userinfo() ||
        url->has_query())
        return refused;
    if (!url->encoded_path().empty() && url->encoded_path() != "/") return refused;
    Place place;
    place.secure = url->scheme() == "https";
    place.host = url->host_address();
    place.port = url->has_port() ? std::string{url->port()} : place.secure ? "443" : "80";
    place.authority = std::string{url->encoded_host_and_port()};
    if (!settings.token.empty() && !place.secure && !WebServer::is_loopback(place.host))
        return Error{
            fmt::format("{} {}: over http others could read the token: it is sent over https, or to this machine only",
                        settings.server_option, server)};
    return place;
}

Result<void> prepare(asio::ssl::context& tls, const HttpClient::Settings& settings) {
    SSL_CTX_set_min_proto_version(tls.native_handle(), TLS1_2_VERSION);
    error_code error;
    if (settings.authorities.empty())
        tls.set_default_verify_paths(error);
    else
        tls.load_verify_file(settings.authorities.string(), error);
    if (error)
        return Error{
            fmt::format("{} {}: {}", settings.authorities_option, settings.authorities.string(), error.message())};
    return {};
}

http::request<http::string_body> request_for(http::verb verb, const std::string& path, const Place& place,
                                             const std::string& token) {
    http::request<http::string_body> request{verb, boost::beast::string_view{path.data(), path.size()}, 11};
    request.set(http::field::host, place.authority);
    request.set(http::field::connection, "close");
    if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    return request;
}

/// The step that failed; without an error, none.
struct Outcome {
    const char* what = "";
    error_code error;
    bool may_have_arrived = false;  ///< the whole request
};

using Request = http::request<http::string_body>;

/// How an answer is read, once the request has gone: whole, or part by part.
struct WholeAnswer {
    http::response_parser<http::string_body>& parser;
    std::chrono::seconds patience;

    template <typename AnyStream>
    Task<error_code> read(AnyStream& stream) {
        error_code error;
        beast::flat_buffer buffer;
        beast::get_lowest_layer(stream).expires_after(patience);
        co_await http::async_read(stream, buffer, parser, asio::redirect_error(awaiting, error));
        co_return error;
    }
};

struct AnswerInParts {
    http::response_parser<http::buffer_body>& parser;
    HttpClient::Answer& answer;
    const HttpClient::Take& take;
    std::chrono::seconds patience;

    template <typename AnyStream>
    Task<error_code> read(AnyStream& stream) {
        constexpr std::size_t part_octets_max = 64 << 10;  // chosen: a few packets of TCP's window
        error_code error;
        beast::flat_buffer buffer;
        auto& lowest = beast::get_lowest_layer(stream);
        lowest.expires_after(patience);
        co_await http::async_read_header(stream, buffer, parser, asio::redirect_error(awaiting, error));
        if (error) co_return error;
        answer.status = parser.get().result_int();
        std::vector<char> part(part_octets_max);
        while (!parser.is_done()) {
            auto& body = parser.get().body();
            body.data = part.data();
            body.size = part.size();
            lowest.expires_after(patience);  // anew: taking a part may have waited
            co_await http::async_read(stream, buffer, parser, asio::redirect_error(awaiting, error));
            if (error == http::error::need_buffer) error = {};
            if (error) co_return error;
            const std::string_view came{part.data(), part.size() - body.size};
            if (came.empty()) continue;
            if (answer.status == 200) {
                if (!take(came)) co_return asio::error::operation_aborted;
            } else if (answer.body.size() + came.size() <= HttpClient::problem_octets_max) {
                answer.body += came;
            } else {
                co_return http::error::body_limit;
            }
        }
        co_return error;
    }
};

/// Sends the request and reads its answer; the first failure is the outcome.
template <typename AnyStream, typename Reading>
Task<Outcome> exchange(AnyStream& stream, Request& request, Reading& reading, std::chrono::seconds patience) {
    Outcome outcome;
    outcome.what = "the request could not be sent";
    beast::get_lowest_layer(stream).expires_after(patience);
    co_await http::async_write(stream, request, asio::redirect_error(awaiting, outcome.error));
    outcome.may_have_arrived = !outcome.error || outcome.error == beast::error::timeout;  // may coincide
    if (outcome.error) co_return outcome;
    outcome.what = "no answer";
    outcome.error = co_await reading.read(stream);
    co_return outcome;
}

template <typename Reading>
Task<Outcome> ask(Place place, asio::ssl::context& tls, Request& request, Reading reading,
                  std::chrono::seconds patience) {
    Outcome outcome;
    auto executor = co_await asio::this_coro::executor;
    asio::ip::basic_resolver<tcp, Executor> resolver{executor};
    outcome.what = "its address is not found";
    const auto ends =
        co_await resolver.async_resolve(place.host, place.port, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    Stream stream{executor};
    stream.expires_after(patience);
    outcome.what = "no connection";
    co_await stream.async_connect(ends, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    if (!place.secure) co_return co_await exchange(stream, request, reading, patience);
    TlsStream secure{std::move(stream), tls};
    secure.set_verify_mode(asio::ssl::verify_peer);
    secure.set_verify_callback(asio::ssl::host_name_verification{place.host});
    SSL_set_tlsext_host_name(secure.native_handle(), place.host.c_str());
    beast::get_lowest_layer(secure).expires_after(patience);
    outcome.what = "no safe connection";
    co_await secure.async_handshake(asio::ssl::stream_base::client, asio::redirect_error(awaiting, outcome.error));
    if (outcome.error) co_return outcome;
    co_return co_await exchange(secure, request, reading, patience);
}

/// Runs a request to its end, or until `stop` says so. None: it was broken off.
std::optional<Outcome> outcome_of(Task<Outcome> asking, const HttpClient::Stop& stop) {
    constexpr std::chrono::milliseconds look_every{50};
    std::optional<Outcome> outcome;
    bool over = false;
    asio::io_context io{1};
    asio::co_spawn(io, std::move(asking), [&](const std::exception_ptr& broken, Outcome done) {
        over = true;
        if (!broken) outcome = done;
    });
    while (!over && !(stop && stop())) io.run_for(look_every);
    return outcome;
}

std::string words_of(const Outcome& outcome, const std::string& server) {
    return fmt::format("{}: {}: {}", server, outcome.what, outcome.error.message());
}

}  // namespace

Result<void> HttpClient::check() const {
    if (const auto place = place_of(settings_); !place) return place.error();
    asio::ssl::context tls{asio::ssl::context::tls_client};
    return prepare(tls, settings_);
}

Result<HttpClient::Answer> HttpClient::post(const std::string& path, const std::string& json) const {
    const auto place = place_of(settings_);
    if (!place) return place.error();
    asio::ssl::context tls{asio::ssl::context::tls_client};
    if (auto ready = prepare(tls, settings_); !ready) return ready.error();
    auto request = request_for(http::verb::post, path, *place, settings_.token);
    request.set(http::field::content_type, "application/json");
    request.body() = json;
    request.prepare_payload();
    http::response_parser<http::string_body> parser;
    parser.body_limit(answer_octets_max);
    const auto outcome =
        outcome_of(ask(*place, tls, request, WholeAnswer{parser, settings_.answer_patience}, settings_.patience), {});
    if (!outcome) return Answer{.lost = fmt::format("{}: the request was broken off", settings_.server)};
    if (outcome->error && !outcome->may_have_arrived) return Error{words_of(*outcome, settings_.server)};
    if (outcome->error) return Answer{.lost = words_of(*outcome, settings_.server)};
    return Answer{.status = parser.get().result_int(), .body = std::move(parser.get().body())};
}

Result<HttpClient::Answer> HttpClient::get(const std::string& path, const Take& take, const Stop& stop) const {
    const auto place = place_of(settings_);
    if (!place) return place.error();
    asio::ssl::context tls{asio::ssl::context::tls_client};
    if (auto ready = prepare(tls, settings_); !ready) return ready.error();
    auto request = request_for(http::verb::get, path, *place, settings_.token);
    http::response_parser<http::buffer_body> parser;
    parser.body_limit(boost::none);
    Answer answer;
    const auto outcome = outcome_of(
        ask(*place, tls, request, AnswerInParts{parser, answer, take, settings_.answer_patience}, settings_.patience),
        stop);
    if (!outcome) return Answer{.lost = "the request was broken off"};
    if (outcome->error && answer.status == 0)
        return Error{fmt::format("{}: {}", outcome->what, outcome->error.message())};
    if (outcome->error) answer.lost = fmt::format("its answer was cut off: {}", outcome->error.message());
    return answer;
}

}  // namespace aeolis::server
