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
#include <string>
#include <vector>

namespace aeolis::server {

/// HTTP/1.1 and WebSocket, with TLS where there is a certificate: sockets and protocol only; what is said, and to whom,
/// is decided elsewhere.
///
/// Thread   run() is the network thread: handlers and sessions are called there and must not block
/// Limits   below; a request beyond one is answered with its status and the limit's name, or the connection is closed
/// Faults   a peer that breaks the protocol, is slow or dead costs its own connection only
/// Safety   requests whose Host is neither a loopback name nor one of ours, or whose Origin is not our own page, are
///          refused: a page of another site, or a name that was rebound to this address, cannot command. Every answer
///          carries a content security policy
class WebServer {
  public:
    static constexpr std::size_t header_octets_max = 16 << 10;   ///< ours
    static constexpr std::size_t message_octets_max = 64 << 10;  ///< ours: a command with every argument is under 2 KiB
    static constexpr std::size_t streams_max = 1000;             ///< ours: what bench/load_bench shows
    static constexpr std::size_t connections_besides =
        64;  ///< ours: for who asks something while all streams are taken
    static constexpr std::size_t connections_each_max = 100;  ///< ours: of one address that is not this machine's own

    struct Handlers {
        std::function<void(HttpRequest, Respond)> request;
        /// How long a request's body may be, by who asks for what; null: HttpRequest::body_octets_max.
        std::function<std::size_t(const Credentials&, std::string_view method, std::string_view path)> body_octets;
        /// A client asks for /api/v1/stream: 200 lets it in, anything else is the answer.
        std::function<HttpResponse(const Credentials&)> admit_stream;
        /// It was let in. `wake` tells the connection that next_message() has something.
        std::function<std::shared_ptr<StreamSession>(const Credentials&, StreamFormat, std::function<void()> wake)>
            open_stream;
    };
    static constexpr std::chrono::milliseconds farewell_max{
        1'000};  ///< ours: for streams to be closed when the server ends
    struct Settings {
        std::string address = "127.0.0.1";
        std::uint16_t port = 0;             ///< 0: a free one
        std::vector<std::string> names;     ///< by which browsers call this server, besides those of loopback
        std::filesystem::path certificate;  ///< PEM, the whole chain; empty: no TLS
        std::filesystem::path key;          ///< PEM
        std::chrono::milliseconds request_max{
            30'000};  ///< ours: for the next request to arrive whole, and for an answer to go on
        std::chrono::milliseconds silence_max{
            20'000};  ///< ours: a WebSocket peer that answers no ping for so long is dead
        /// Ours: of bodies that lie in memory until their clients have taken them. What would go beyond is answered
        /// with 503, but not what has half a megaoctet at most, as the console's own files, nor what is alone: series
        /// of 1 000 000 samples have some 55 MB.
        std::size_t answers_octets_max = 256 << 20;
        std::size_t streams = streams_max;  ///< open at once; one more gets 503
    };

    /// Binds and listens. Fails with one line that names the address or the file.
    static Result<std::unique_ptr<WebServer>> open(const Settings& settings, Handlers handlers);
    ~WebServer();
    /// Whether only this machine reaches the address; false of what is no address.
    static bool is_loopback(const std::string& address);

    std::uint16_t port() const;
    void run();                               ///< until stop()
    void stop();                              ///< from any thread; streams are closed with 1001 before
    void post(std::function<void()> action);  ///< run it on the network thread; from any thread
    void every(unsigned milliseconds, std::function<void()> action);  ///< on the network thread, before run()
    std::size_t connections() const;                                  ///< on the network thread
    bool secure() const;                                              ///< over TLS

  private:
    struct State;
    explicit WebServer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::server
