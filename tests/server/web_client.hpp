// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// A small client for tests of the server on a loopback socket; every wait ends after some seconds.
namespace aeolis::test {

using Headers = std::vector<std::pair<std::string, std::string>>;

struct WebReply {
    unsigned status = 0;
    std::string content_type, cache_control, set_cookie, security_policy, body, next_after;
    Headers fields{};  ///< all of them
};
WebReply web_request(std::uint16_t port, std::string_view method, std::string_view target, std::string_view body = {},
                     const Headers& headers = {});
/// Sends the octets as they are, and returns all that is received until the server closes.
std::string raw_exchange(std::uint16_t port, std::string_view octets);

class StreamClient {
  public:
    /// `subprotocols` as in the header; an upgrade that was refused has no stream, and its status.
    StreamClient(std::uint16_t port, const std::string& subprotocols, const Headers& headers = {});
    ~StreamClient();
    StreamClient(StreamClient&&) noexcept;

    bool open() const;
    unsigned status() const;  ///< 101 when open
    std::string subprotocol() const;
    void send(std::string_view payload, bool binary);
    /// The next message; none when the server has closed, or sent nothing for some seconds.
    std::optional<std::string> receive();
    std::uint16_t close_code() const;  ///< after receive() gave none
    std::string close_words() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::test
