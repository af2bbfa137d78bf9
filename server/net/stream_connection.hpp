#pragma once

#include "server/net/http_message.hpp"
#include "server/net/sockets.hpp"
#include "server/net/stream_session.hpp"

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace aeolis::server::net {

/// Connections that have something to write. All that comes due while the network thread does one thing is written after it, once
/// a connection: a client gets eight batches in one message and one system call, not in eight.
class WriteTurn {
  public:
    class Writer {
      public:
        virtual ~Writer() = default;
        virtual void write() = 0;

      private:
        friend class WriteTurn;
        bool due_ = false;
    };
    explicit WriteTurn(Executor executor) : executor_(std::move(executor)) {}
    void add(std::shared_ptr<Writer> writer);

  private:
    void write_all();

    Executor executor_;
    std::vector<std::shared_ptr<Writer>> due_, now_;
};

/// What a connection of the stream needs of the server around it.
struct StreamService {
    WriteTurn& turn;
    std::size_t message_octets_max = 0; ///< of one that a client sends
    unsigned silence_seconds_max = 0;   ///< a peer that answers no ping for so long is dead
    std::function<std::shared_ptr<StreamSession>(StreamFormat, std::function<void()> wake)> open;
};

using UpgradeRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// Accepts the upgrade and serves the session until either side ends.
Task<> serve_stream(Stream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol, StreamService service);
Task<> serve_stream(TlsStream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol, StreamService service);

} // namespace aeolis::server::net
