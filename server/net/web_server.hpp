// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/api/http_message.hpp"
#include "server/api/stream_session.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// HTTP/1.1 and WebSocket, with TLS when there is a certificate. Sockets and protocol only: handlers decide the content
/// and the access.
///
/// Thread   run() is the network thread: it calls handlers and sessions, which must not block
/// Limits   below; a request beyond one gets its status and the limit's name, or the connection is closed
/// Faults   a peer that breaks the protocol, is slow or dead costs its own connection only
/// Safety   refuses requests whose Host is neither loopback nor one of `names`, or whose Origin is not our own page:
///          neither a page of another site nor a name rebound to this address can send commands. Every answer has a
///          content security policy
class WebServer {
  public:
    static constexpr std::size_t header_octets_max = 16 << 10;  ///< chosen
    /// Chosen: a command with every argument is under 2 KiB.
    static constexpr std::size_t message_octets_max = 64 << 10;
    static constexpr std::size_t streams_max = 1000;        ///< chosen: the number that bench/load_bench shows
    static constexpr std::size_t connections_besides = 64;  ///< chosen: for requests while all streams are taken
    static constexpr std::size_t strangers_each_max = 100;  ///< chosen: from one network, before they are known
    static constexpr std::size_t strangers_part = 4;        ///< chosen: a fourth of all, at least connections_besides

    struct Handlers {
        std::function<void(HttpRequest, Respond)> request;
        /// Told of each response that the server gives by itself: to what breaks HTTP, its origin or a limit, and the
        /// denial of a stream. `route` as in the metrics. Null: nobody counts.
        std::function<void(const char* route, unsigned status)> refused;
        /// Finds the person whose share of the connections a request takes. None: a stranger; empty: somebody known, on
        /// a server without accounts. Null: everybody is known.
        std::function<std::optional<std::string>(const Credentials&)> person;
        /// The longest body accepted for this request; null: HttpRequest::body_octets_max.
        std::function<std::size_t(const Credentials&, std::string_view method, std::string_view path)> body_octets;
        /// Decides on a request for /api/v1/stream: 200 admits the client, anything else is the response.
        std::function<HttpResponse(const Credentials&)> admit_stream;
        /// Opens the session of an admitted client. `wake` tells the connection that next_message() has something.
        std::function<std::shared_ptr<StreamSession>(const Credentials&, StreamFormat, std::function<void()> wake)>
            open_stream;
    };
    /// Chosen: to close streams when the server stops.
    static constexpr std::chrono::milliseconds close_timeout{1'000};
    struct Settings {
        std::string address = "127.0.0.1";
        std::uint16_t port = 0;                      ///< 0: any free port
        std::vector<std::string> names;              ///< host names used by browsers, besides loopback's
        std::vector<std::string> trusted_proxies{};  ///< addresses and networks whose X-Forwarded-For is believed
        std::filesystem::path certificate;           ///< PEM, the whole chain; empty: no TLS
        std::filesystem::path key;                   ///< PEM
        std::chrono::milliseconds request_max{
            30'000};  ///< chosen: for a request to arrive, and for an answer to proceed
        std::chrono::milliseconds silence_max{
            20'000};  ///< chosen: a WebSocket peer that answers no ping for this long is dead
        /// Chosen: for response bodies in memory until their clients have taken them; beyond it a response is 503. A
        /// body of at most half a megaoctet (the console's files) or one that is alone is exempt: series of 1 000 000
        /// samples have about 55 MB.
        std::size_t answers_octets_max = 256 << 20;
        std::size_t streams = streams_max;  ///< open at once; a further one gets 503
    };

    /// Binds and listens. Fails with one line that names the address or the file.
    static Result<std::unique_ptr<WebServer>> open(const Settings& settings, Handlers handlers);
    ~WebServer();
    /// Whether only this machine reaches the address; false for text that is not an address.
    static bool is_loopback(const std::string& address);

    std::uint16_t port() const;
    void run();                               ///< until stop()
    void stop();                              ///< from any thread; closes streams with 1001 first
    void post(std::function<void()> action);  ///< runs it on the network thread; from any thread
    void every(unsigned milliseconds, std::function<void()> action);  ///< on the network thread; call before run()
    std::size_t connections() const;                                  ///< on the network thread
    bool secure() const;                                              ///< over TLS
    /// Reads certificate and key again, for connections from then on. When it fails, the previous ones stay in use.
    /// Call on the network thread.
    Result<void> renew_certificate();

  private:
    struct State;
    explicit WebServer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::server
