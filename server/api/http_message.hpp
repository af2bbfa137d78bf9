// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/access/access.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace aeolis::server {

struct HttpRequest {
    /// Ours: a scenario with every field is under 2 KiB; read as JSON in 25 ms.
    static constexpr std::size_t body_octets_max = 256 << 10;

    std::string method;
    std::string path;   ///< decoded, without the query
    std::string query;  ///< as it stands after '?', still percent-encoded
    std::string body;
    Credentials credentials{};
    std::function<bool()>
        gone{};  ///< whether who asked has left: what still works on it may stop; from any thread; null: never told
};

/// The next part of a body, which may be empty; none: that was all.
using BodyPart = Result<std::optional<std::string>>;

struct HttpResponse {
    unsigned status = 200;
    std::string content_type = "application/json";
    std::string cache_control = "no-store";
    std::string body;
    std::string set_cookie{};  ///< empty: none
    std::string next_after{};  ///< of a page: the header Aeolis-Next-After; empty: none
    /// Null: the body is all. Else it is the first part, and this is called for each further one, when the one before
    /// it has been taken by the client; the answer may come from any thread. An Error breaks the connection off: the
    /// client sees that it has not all.
    std::function<void(std::function<void(BodyPart)>)> more{};
};

/// To be called once, from any thread.
using Respond = std::function<void(HttpResponse)>;

}  // namespace aeolis::server
