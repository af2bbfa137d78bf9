// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace aeolis::server {

/// The content codings that a client accepts, of those that this server has (RFC 9110, 12.5.3).
struct AcceptedCodings {
    bool gzip = false;     ///< accepted, and preferred no less than plain text
    bool identity = true;  ///< plain text is accepted
};
/// Reads the header Accept-Encoding, with its lines joined by commas. Malformed parts count as absent.
AcceptedCodings accepted_codings(std::string_view accept_encoding);

/// Compresses a text that comes in parts (gzip, RFC 1952).
///
/// Memory   270 kB, whatever the length
class Gzip {
  public:
    Gzip();
    /// The next octets of the compressed text; they may be none.
    std::string add(std::string_view part);
    /// The last octets. Call once, after the last part.
    std::string end();

  private:
    struct State;
    std::string deflated(std::string_view part, int flush);
    std::shared_ptr<State> state_;
};

/// A shorter response is sent uncompressed, because compressed it would take as many network packets.
inline constexpr std::size_t coded_octets_min = 1'024;  // chosen: below one TCP segment

/// Compresses the body of a response that is text, if the client accepts that. A body in parts is compressed part by
/// part, on the thread that gives the part.
void encode(HttpResponse& response, const AcceptedCodings& accepted);

/// Returns a callback that encodes the response to GET or HEAD; for other requests, returns `respond` itself.
Respond in_accepted_coding(const HttpRequest& request, const Respond& respond);

}  // namespace aeolis::server
