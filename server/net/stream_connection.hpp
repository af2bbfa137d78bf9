// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"
#include "server/api/stream_session.hpp"
#include "server/net/sockets.hpp"

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <string_view>

namespace aeolis::server::net {

/// Connections that have something to write. All that comes due while the network thread does one thing is written
/// after it, once a connection: a client gets eight batches in one message and one system call, not in eight.
class WriteTurn {
  public:
    class Writer {
      public:
        virtual ~Writer() = default;
        virtual void write() = 0;
        /// Has the processor fetch what write() is about to read: a send leaves nothing of theirs in the nearest
        /// memory.
        virtual void fetch() const = 0;

      private:
        friend class WriteTurn;
        bool due_ = false;
    };
    explicit WriteTurn(Executor executor) : executor_(std::move(executor)) {}
    void add(std::shared_ptr<Writer> writer);
    /// Empty, and for who writes now: one for all, so that it stays in the processor's nearest memory.
    std::string& frames() {
        frames_.clear();
        return frames_;
    }

  private:
    void post();
    void write_all();  ///< or those that come to it in a turn; the rest after what else the thread has to do

    Executor executor_;
    std::string frames_;
    std::deque<std::shared_ptr<Writer>> due_;
    bool posted_ = false;
};

/// The streams that are open, each with a place.
///
/// Rule     there are so many places at most: who has no stream finds the server, too
/// Thread   the network thread
class OpenStreams {
  public:
    class Member {
      public:
        virtual ~Member() = default;
        /// Takes leave of its client; its place is free when that has answered, or has gone.
        virtual void end() = 0;
    };
    /// One of them, for as long as this lives.
    class Place {
      public:
        Place(OpenStreams& all, Member& member) : all_(all), place_(all.members_.insert(all.members_.end(), &member)) {}
        ~Place();
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;

      private:
        OpenStreams& all_;
        std::list<Member*>::iterator place_;
    };
    explicit OpenStreams(std::size_t max) : max_(max) {}

    /// Why there is no place for one more; empty: there is.
    std::string refusal() const;
    bool ending() const { return ending_; }
    /// Ends all of them. `gone` is called when none is left, at once when there is none, unless forget() came first.
    void end(std::function<void()> gone);
    void forget() { gone_ = nullptr; }

  private:
    std::size_t max_;
    std::list<Member*> members_;
    bool ending_ = false;
    std::function<void()> gone_;
};

/// What a connection of the stream needs of the server around it.
struct StreamService {
    WriteTurn& turn;
    OpenStreams& streams;
    std::size_t message_octets_max = 0;       ///< of one that a client sends
    std::chrono::milliseconds silence_max{};  ///< a peer that answers no ping for so long is dead
    std::function<std::shared_ptr<StreamSession>(StreamFormat, std::function<void()> wake)> open;
};

using UpgradeRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// Accepts the upgrade and serves the session until either side ends. Takes its place of service.streams before
/// anything else.
Task<> serve_stream(Stream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service);
Task<> serve_stream(TlsStream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service);

}  // namespace aeolis::server::net
