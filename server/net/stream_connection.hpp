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

/// The connections with something to write. Each writes once after the network thread's present work: a client gets all
/// batches of that work in one message and one system call, not one each.
class WriteScheduler {
  public:
    class Writer {
      public:
        virtual ~Writer() = default;
        virtual void write() = 0;
        /// Prefetches into the cache the state that write() reads: a send evicts other connections' state from it.
        virtual void fetch() const = 0;

      private:
        friend class WriteScheduler;
        bool due_ = false;
    };
    explicit WriteScheduler(Executor executor) : executor_(std::move(executor)) {}
    void add(std::shared_ptr<Writer> writer);
    /// The shared buffer for the current writer, emptied. One for all, so that it stays in the cache.
    std::string& frames() {
        frames_.clear();
        return frames_;
    }

  private:
    void post();
    void write_all();  ///< writes for about turn_max; the rest after the thread's other work

    Executor executor_;
    std::string frames_;
    std::deque<std::shared_ptr<Writer>> due_;
    bool posted_ = false;
};

/// The open streams, each with a place.
///
/// Rule     the number of places is limited, so that clients without a stream can still reach the server
/// Thread   the network thread
class OpenStreams {
  public:
    class Member {
      public:
        virtual ~Member() = default;
        /// Closes the stream; its place is free once the client has answered or has gone.
        virtual void end() = 0;
    };
    /// The place of one stream during its lifetime.
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

    /// Why there is no free place; empty: there is one.
    std::string refusal() const;
    bool ending() const { return ending_; }
    /// Closes all streams. Calls `gone` once none is left (at once when there is none), unless forget() was called
    /// before.
    void end(std::function<void()> gone);
    void forget() { gone_ = nullptr; }

  private:
    std::size_t max_;
    std::list<Member*> members_;
    bool ending_ = false;
    std::function<void()> gone_;
};

/// What a stream connection needs from the server.
struct StreamService {
    WriteScheduler& scheduler;
    OpenStreams& streams;
    std::size_t message_octets_max = 0;       ///< of one client message
    std::chrono::milliseconds silence_max{};  ///< a peer that answers no ping for this long is dead
    std::function<std::shared_ptr<StreamSession>(StreamFormat, std::function<void()> wake)> open;
};

using UpgradeRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// Accepts the upgrade and serves the session until either side closes it. First takes its place in service.streams.
Task<> serve_stream(Stream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service);
Task<> serve_stream(TlsStream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service);

}  // namespace aeolis::server::net
