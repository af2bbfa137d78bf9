// SPDX-License-Identifier: Apache-2.0
#include "server/net/stream_connection.hpp"

#include "server/net/frame_stream.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <spdlog/spdlog.h>

namespace aeolis::server::net {
namespace {

namespace websocket = beast::websocket;

constexpr const char* server_ends = "the server ends";
constexpr std::size_t turn_octets_max = 64 << 10;  // chosen: a client that catches up lets others write in between
/// Chosen: octets unsent in the kernel per client. Further items wait in the session, where they are thinned; and pings
/// stay close enough to the front that a slow client does not seem dead.
using UnsentMax = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_NOTSENT_LOWAT>;
constexpr int unsent_octets_max = 64 << 10;
constexpr std::chrono::milliseconds turn_max{
    20};  // chosen: for all writers before other work (live, 1000 clients take 8 ms)

constexpr std::size_t writers_between_looks = 8;  // chosen: a write takes microseconds, when catching up up to 1 ms
constexpr std::size_t writers_ahead = 2;  // prefetches a session this many entries ahead, its writer twice as far
constexpr std::size_t cache_line_octets = 64;

/// Prefetches the first octets of an object into the cache.
void fetch_octets(const void* object, std::size_t octets) {
    for (std::size_t at = 0; at < octets; at += cache_line_octets)
        __builtin_prefetch(static_cast<const char*>(object) + at);
}

/// A client's connection. It takes messages from its session as fast as the kernel accepts them; all else waits in the
/// session.
template <typename AnyStream>
class Connection final : public WriteScheduler::Writer,
                         public OpenStreams::Member,
                         public std::enable_shared_from_this<Connection<AnyStream>> {
  public:
    Connection(AnyStream stream, StreamService service)
        : frames_(std::move(stream)), socket_(frames_), service_(std::move(service)), place_(service_.streams, *this),
          replay_(frames_.get_executor()) {}

    Task<> serve(UpgradeRequest request, StreamFormat format, std::string_view subprotocol);
    void write() override;
    void fetch() const override;
    void end() override;

  private:
    Task<bool> accept(UpgradeRequest request, std::string_view subprotocol);
    Task<> read();
    Task<> close(websocket::close_reason reason);
    void due();
    void wait_for_due();
    bool gather(std::string& frames);

    bool open_ = true;  ///< false: no further messages are sent
    FrameStream<AnyStream> frames_;
    std::shared_ptr<StreamSession> session_;
    websocket::stream<FrameStream<AnyStream>> socket_;  ///< layered over frames_
    StreamService service_;
    OpenStreams::Place place_;
    Timer replay_;  ///< expires when the session has something due
};

template <typename AnyStream>
Task<> Connection<AnyStream>::serve(UpgradeRequest request, StreamFormat format, std::string_view subprotocol) {
    const auto self = this->shared_from_this();
    if (!co_await accept(std::move(request), subprotocol)) co_return;
    // The session never outlives this object, so it may hold `this`; the frames may outlive it.
    session_ = service_.open(format, [this] { due(); });
    frames_.when_drained([weak = this->weak_from_this()] {
        if (const auto alive = weak.lock()) alive->due();
    });
    due();
    if (service_.streams.ending()) end();  // the server began to end since admission
    co_await read();
    open_ = false;
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
}

template <typename AnyStream>
Task<bool> Connection<AnyStream>::accept(UpgradeRequest request, std::string_view subprotocol) {
    beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own time-outs
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.idle_timeout = service_.silence_max;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
        response.set(beast::http::field::sec_websocket_protocol,
                     beast::string_view{subprotocol.data(), subprotocol.size()});
    }));
    socket_.read_message_max(0);  // the limit is checked below: Beast would close without a reason
    error_code error;
    beast::get_lowest_layer(socket_).socket().set_option(UnsentMax{unsent_octets_max},
                                                         error);  // optional
    co_await socket_.async_accept(request, asio::redirect_error(awaiting, error));
    co_return !error;
}

template <typename AnyStream>
Task<> Connection<AnyStream>::read() {
    beast::flat_buffer buffer;
    error_code error;
    for (;;) {
        co_await socket_.async_read_some(buffer, service_.message_octets_max + 1 - buffer.size(),
                                         asio::redirect_error(awaiting, error));
        if (error) co_return;
        if (buffer.size() > service_.message_octets_max) {
            spdlog::warn("stream: a client sent more than {} octets in one message and is closed",
                         service_.message_octets_max);
            // A named variable: g++ 12 destroys temporary aggregates of a co_await twice.
            const websocket::close_reason reason{
                websocket::close_code::too_big,
                fmt::format("a message has at most {} octets", service_.message_octets_max)};
            co_await close(reason);
            co_return;
        }
        if (!socket_.is_message_done()) continue;
        if (open_)  // else the close was sent, and replies would never be taken
            session_->on_message({static_cast<const char*>(buffer.data().data()), buffer.size()});
        buffer.consume(buffer.size());
    }
}

template <typename AnyStream>
Task<> Connection<AnyStream>::close(websocket::close_reason reason) {
    const auto self = this->shared_from_this();
    open_ = false;
    error_code ignored;
    co_await socket_.async_close(reason, asio::redirect_error(awaiting, ignored));  // read() then ends too
}

template <typename AnyStream>
void Connection<AnyStream>::end() {
    if (session_ && open_)
        asio::co_spawn(socket_.get_executor(), close({websocket::close_code::going_away, server_ends}), asio::detached);
}

template <typename AnyStream>
void Connection<AnyStream>::due() {
    if (auto alive = this->weak_from_this().lock()) service_.scheduler.add(std::move(alive));
}

template <typename AnyStream>
void Connection<AnyStream>::wait_for_due() {
    const auto at = session_->due();
    if (!at) return;
    replay_.expires_at(*at);  // replaces an earlier time
    replay_.async_wait([weak = this->weak_from_this()](error_code error) {
        const auto alive = weak.lock();
        if (alive && !error) alive->due();
    });
}

/// Appends frames for this turn. True when the session may have more than fits.
template <typename AnyStream>
bool Connection<AnyStream>::gather(std::string& frames) {
    const bool binary = session_->format() == StreamFormat::protobuf;
    while (frames.size() < turn_octets_max) {
        const auto message = session_->next_message();
        if (!message) return false;
        append_frame(frames, *message, binary);
    }
    return true;
}

template <typename AnyStream>
void Connection<AnyStream>::write() {
    auto& frames = service_.scheduler.frames();
    const bool more = open_ && !frames_.busy() && gather(frames);
    if (auto why = session_->closing(); open_ && !why.empty()) {
        asio::co_spawn(socket_.get_executor(), close({websocket::close_code::policy_error, why}), asio::detached);
        return;
    }
    if (!frames.empty()) frames_.send(frames);
    if (more) return service_.scheduler.add(this->shared_from_this());
    if (open_ && !frames_.busy()) wait_for_due();
}

template <typename AnyStream>
void Connection<AnyStream>::fetch() const {
    fetch_octets(session_.get(), sizeof(StreamSession));
    frames_.fetch();
}

}  // namespace

OpenStreams::Place::~Place() {
    all_.members_.erase(place_);
    if (all_.members_.empty() && all_.gone_) std::exchange(all_.gone_, nullptr)();
}

std::string OpenStreams::refusal() const {
    if (ending_) return server_ends;
    return members_.size() < max_ ? "" : fmt::format("{} streams are open already", max_);
}

void OpenStreams::end(std::function<void()> gone) {
    ending_ = true;
    if (members_.empty()) return gone();
    gone_ = std::move(gone);
    for (auto* member : members_) member->end();
}

void WriteScheduler::add(std::shared_ptr<Writer> writer) {
    if (std::exchange(writer->due_, true)) return;
    due_.push_back(std::move(writer));
    post();
}

void WriteScheduler::post() {
    if (!std::exchange(posted_, true)) asio::post(executor_, [this] { write_all(); });
}

void WriteScheduler::write_all() {
    posted_ = false;
    const auto end = std::chrono::steady_clock::now() + turn_max;
    for (auto left = due_.size(); left > 0; --left) {
        if (left % writers_between_looks == 0 && std::chrono::steady_clock::now() > end) break;
        const auto writer = std::move(due_.front());
        due_.pop_front();
        if (due_.size() > 2 * writers_ahead) fetch_octets(due_[2 * writers_ahead].get(), 4 * cache_line_octets);
        if (due_.size() > writers_ahead) due_[writers_ahead]->fetch();
        writer->due_ = false;
        writer->write();
    }
    if (!due_.empty()) post();
}

Task<> serve_stream(Stream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service) {
    const auto connection = std::make_shared<Connection<Stream>>(std::move(stream), std::move(service));
    co_await connection->serve(std::move(request), format, subprotocol);
}

Task<> serve_stream(TlsStream stream, UpgradeRequest request, StreamFormat format, std::string_view subprotocol,
                    StreamService service) {
    const auto connection = std::make_shared<Connection<TlsStream>>(std::move(stream), std::move(service));
    co_await connection->serve(std::move(request), format, subprotocol);
}

}  // namespace aeolis::server::net
