// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/body_budget.hpp"
#include "server/net/connection_count.hpp"
#include "server/net/sockets.hpp"
#include "server/net/stream_connection.hpp"
#include "server/net/trusted_proxies.hpp"
#include "server/net/waiting_peers.hpp"
#include "server/net/web_server.hpp"

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <string>
#include <vector>

namespace aeolis::server::net {

/// State shared by the connections of a server; lives as long as its io_context.
struct HttpService {
    explicit HttpService(const WebServer::Settings& settings)
        : names(settings.names), request_max(settings.request_max), silence_max(settings.silence_max),
          answers(settings.answers_octets_max), streams(settings.streams) {}

    WebServer::Handlers handlers;
    std::vector<std::string> names;  ///< host names used by browsers, besides loopback's
    bool secure = false;             ///< reached over TLS
    std::chrono::milliseconds request_max, silence_max;
    WaitingPeers waiting;
    BodyBudget answers;
    TrustedProxies proxies;
    OpenStreams streams;
    asio::io_context io{1};
    WriteScheduler scheduler{io.get_executor()};
};

/// The other end of a connection.
struct Peer {
    std::string address;
    std::shared_ptr<ConnectionCount::Place> place;  ///< null: the connection is refused
};

/// Reads requests and answers each, until either side closes the connection or it becomes a stream.
Task<> serve_http(Stream& stream, HttpService& service, Peer peer);
Task<> serve_http(TlsStream& stream, HttpService& service, Peer peer);

inline constexpr std::chrono::seconds refusal_max{1};  ///< chosen: to answer a connection beyond the limit

/// Answers a connection beyond the limit, whatever its request: 503 with the reason.
Task<> refuse_connection(Stream& stream, const std::string& reason);
Task<> refuse_connection(TlsStream& stream, const std::string& reason);

}  // namespace aeolis::server::net
