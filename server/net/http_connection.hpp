// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/body_budget.hpp"
#include "server/net/sockets.hpp"
#include "server/net/stream_connection.hpp"
#include "server/net/waiting_peers.hpp"
#include "server/net/web_server.hpp"

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <string>
#include <vector>

namespace aeolis::server::net {

/// What the connections of one server share; lives as long as its io_context.
struct HttpService {
    explicit HttpService(const WebServer::Settings& settings)
        : names(settings.names), request_max(settings.request_max), silence_max(settings.silence_max),
          answers(settings.answers_octets_max), streams(settings.streams) {}

    WebServer::Handlers handlers;
    std::vector<std::string> names;  ///< by which browsers call the server, besides those of loopback
    bool secure = false;             ///< it is reached over TLS
    std::chrono::milliseconds request_max, silence_max;
    WaitingPeers waiting;
    BodyBudget answers;
    OpenStreams streams;
    asio::io_context io{1};
    WriteTurn turn{io.get_executor()};
};

/// Reads requests and answers each, until either side ends the connection or it has become a stream.
/// @param from  the peer's address
Task<> serve_http(Stream& stream, HttpService& service, std::string from);
Task<> serve_http(TlsStream& stream, HttpService& service, std::string from);

/// Answers a connection that has no place, whatever it asks: 503 with the reason.
Task<> refuse_connection(Stream& stream, const std::string& reason);

}  // namespace aeolis::server::net
