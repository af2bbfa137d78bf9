#pragma once

#include "common/result.hpp"
#include "server/net/http_message.hpp"
#include "server/net/stream_session.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace aeolis::server {

/// HTTP/1.1 and WebSocket on a loopback address: sockets and protocol only; what is said is decided elsewhere.
///
/// Thread   run() is the network thread: handlers and sessions are called there and must not block
/// Limits   below; a request beyond one is answered with its status and the limit's name, or the connection is closed
/// Faults   a peer that breaks the protocol, is slow or dead costs its own connection only
/// Safety   requests whose Host or Origin is not a loopback name are refused: a page of another site, or a name that
///          was rebound to this address, cannot command
class WebServer {
  public:
    static constexpr std::size_t body_octets_max = 1 << 20;     ///< ours: a scenario with every field is under 2 KiB
    static constexpr std::size_t header_octets_max = 16 << 10;  ///< ours
    static constexpr std::size_t message_octets_max = 64 << 10; ///< ours: a command with every argument is under 2 KiB
    static constexpr std::size_t connections_max = 1000;        ///< ours: below the usual 1024 open files
    static constexpr unsigned request_seconds_max = 30;         ///< ours: for the next request to arrive whole
    static constexpr unsigned silence_seconds_max =
        20; ///< ours: a WebSocket peer that answers no ping for so long is dead

    struct Handlers {
        std::function<void(HttpRequest, Respond)> request;
        /// A client opened /api/v1/stream. `wake` tells the connection that next_message() has something.
        std::function<std::shared_ptr<StreamSession>(StreamFormat, std::function<void()> wake)> open_stream;
    };

    /// Binds and listens; port 0 takes a free one. Fails with one line that names the address: not loopback, in use.
    static Result<std::unique_ptr<WebServer>> open(const std::string& address, std::uint16_t port, Handlers handlers);
    ~WebServer();

    std::uint16_t port() const;
    void run();                                                      ///< until stop()
    void stop();                                                     ///< from any thread
    void post(std::function<void()> action);                         ///< run it on the network thread; from any thread
    void every(unsigned milliseconds, std::function<void()> action); ///< on the network thread, before run()
    std::size_t connections() const;                                 ///< on the network thread

  private:
    struct State;
    explicit WebServer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace aeolis::server
