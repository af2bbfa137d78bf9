// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <boost/beast/http/message.hpp>
#include <string>

namespace aeolis::server::net {

using RequestHead = boost::beast::http::request_header<>;

/// Why the head of a request must be answered with 400 and its connection closed; empty: accepted. A head is refused
/// when another server on the way could read another end or another host in it: with several Host or Content-Length, a
/// Transfer-Encoding other than "chunked" alone, both lengths, or HTTP/1.1 without Host. [RFC 9112, 3.2 and 6]
std::string refusal_of_framing(const RequestHead& head);

/// The target of a request, decoded.
struct RequestTarget {
    std::string host;  ///< with its port: of an absolute target, else of the Host field [RFC 9112, 3.2.2]
    std::string path;
    std::string query;  ///< still encoded
};
/// Fails when the target is neither a path nor a whole address.
Result<RequestTarget> target_of(const RequestHead& head);

}  // namespace aeolis::server::net
