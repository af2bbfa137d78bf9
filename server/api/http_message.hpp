// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/access/access.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aeolis::server {

struct HttpRequest {
    /// Chosen: a scenario with every field is under 2 KiB; 256 KiB are parsed as JSON in 25 ms.
    static constexpr std::size_t body_octets_max = 256 << 10;

    std::string method;
    std::string path;   ///< percent-decoded, without the query
    std::string query;  ///< the text after '?', still percent-encoded
    std::string body;
    Credentials credentials{};
    /// Whether the client has disconnected, so that work may stop. Call from any thread. Null: unknown.
    std::function<bool()> disconnected{};
    std::string accept_encoding{};  ///< the header, with its lines joined by commas
};

/// The next part of a body, which may be empty; none at the end of the body.
using BodyPart = Result<std::optional<std::string>>;

struct HttpResponse {
    unsigned status = 200;
    std::string content_type = "application/json";
    std::string cache_control = "no-store";
    std::string body;
    /// Header fields of this response alone: Set-Cookie, Allow, Retry-After, WWW-Authenticate, Upgrade,
    /// Aeolis-Next-After, Link, Vary, Content-Encoding.
    std::vector<std::pair<std::string, std::string>> fields{};
    /// Null: `body` is the whole body. Else `body` is its first part, and this is called for each further part once the
    /// client has taken the one before; the answer may come from any thread. An Error closes the connection, so that
    /// the client sees that the body is incomplete.
    std::function<void(std::function<void(BodyPart)>)> next_part{};

    std::string field(std::string_view name) const;  ///< the value of a field; empty: absent
};

inline constexpr std::string_view about_blank = "about:blank";  ///< the type of every problem: its status says all
/// The reason phrase of a status that this server sends; empty: of another.
std::string reason_phrase(unsigned status);
/// Makes a problem (RFC 9457), the form of every error: the status, its reason phrase, and a sentence that names the
/// fault. 401 names the scheme by which one may be known [RFC 9110, 11.6.1].
HttpResponse error_response(unsigned status, const std::string& error);
/// Makes the problem 426, which names the protocol that is wanted: WebSocket of version 13.
HttpResponse upgrade_response(const std::string& error);
/// Makes a problem that passes by itself, with the time after which the client may send the request again.
HttpResponse retry_response(unsigned status, const std::string& error, std::chrono::seconds after);

/// Sends the response. Call it once, from any thread.
using Respond = std::function<void(HttpResponse)>;

}  // namespace aeolis::server
