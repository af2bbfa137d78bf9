#pragma once

#include "server/access/access.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace aeolis::server {

struct HttpRequest {
    std::string method;
    std::string path;  ///< decoded, without the query
    std::string query; ///< as it stands after '?', still percent-encoded
    std::string body;
    Credentials credentials{};
    std::shared_ptr<std::atomic<bool>> gone{}; ///< true once who asked has left: what still works on it may stop; null: never told
};

struct HttpResponse {
    unsigned status = 200;
    std::string content_type = "application/json";
    std::string cache_control = "no-store";
    std::string body;
    std::string set_cookie{}; ///< empty: none
};

/// To be called once, from any thread.
using Respond = std::function<void(HttpResponse)>;

} // namespace aeolis::server
