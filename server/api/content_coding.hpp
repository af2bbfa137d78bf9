// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace aeolis::server {

/// The content codings that a client accepts, of those that this server has (RFC 9110, 12.5.3).
struct AcceptedCodings {
    bool gzip = false;     ///< accepted, and not less than the text as it is
    bool identity = true;  ///< the text as it is
};
/// Reads the header Accept-Encoding; its lines joined by commas. What is not well formed in it counts as absent.
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

/// A response of this many octets is sent as it is: compressed it would take as many packets of the network.
inline constexpr std::size_t coded_octets_min = 1'024;  // chosen: below one TCP segment

/// Compresses the body of a response that is text, if the client accepts that. A body in parts is compressed part by
/// part, on the thread that gives the part.
void encode(HttpResponse& response, const AcceptedCodings& accepted);

/// A callback that encodes the answer to a reading request; of any other request, the callback itself.
Respond in_accepted_coding(const HttpRequest& request, const Respond& respond);

}  // namespace aeolis::server
