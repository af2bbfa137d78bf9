// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace aeolis::bench {

struct Answered {
    int status = 0;
    std::uint64_t octets = 0;  ///< head and body
};

/// Connects, sends a request over HTTP, reads its answer to the end, and closes. The request has to say "Connection:
/// close".
Answered answer_of(std::uint16_t port, const std::string& request);

/// "GET /x HTTP/1.1" with the headers that the API asks for, and the body, JSON, where there is one.
std::string request_text(const std::string& method, const std::string& target, const std::string& token,
                         const std::string& body = {});

}  // namespace aeolis::bench
