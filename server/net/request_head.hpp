// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <boost/beast/http/message.hpp>
#include <string>

namespace aeolis::server::net {

using RequestHead = boost::beast::http::request_header<>;

/// Why the head of a request must be answered with 400 and its connection closed; empty: accepted. Refused is what
/// another server on the way could read with another end or for another host: several Host or Content-Length, a
/// Transfer-Encoding that is not "chunked" alone, both lengths, HTTP/1.1 without Host. [RFC 9112, 3.2 and 6]
std::string refusal_of_framing(const RequestHead& head);

/// What a request is about, decoded.
struct RequestTarget {
    std::string host;  ///< with its port: of an absolute target, else of the Host field [RFC 9112, 3.2.2]
    std::string path;
    std::string query;  ///< still encoded
};
/// Fails when the target is neither a path nor a whole address.
Result<RequestTarget> target_of(const RequestHead& head);

}  // namespace aeolis::server::net
