// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/sockets.hpp"

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/compose.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <type_traits>
#include <utility>

namespace aeolis::server::net {

/// Appends a message as one unmasked data frame, binary or text: RFC 6455, 5.2.
inline void append_frame(std::string& frames, std::string_view message, bool binary) {
    const auto octets = message.size();
    const std::size_t wide = octets < 126 ? 0 : octets <= 0xFFFF ? 2 : 8;
    std::array<char, 10> header{binary ? '\x82' : '\x81', static_cast<char>(wide == 0   ? octets
                                                                            : wide == 2 ? 126
                                                                                        : 127)};
    for (std::size_t i = 0; i < wide; ++i) header[2 + i] = static_cast<char>(octets >> (8 * (wide - 1 - i)));
    frames.append(header.data(), 2 + wide).append(message);
}

/// A layer between a WebSocket and its socket. Our data frames bypass the WebSocket: one system call writes as much as
/// the kernel takes. They never interrupt another frame, including the WebSocket's own pings, pongs and closes.
///
/// In       data frames by send(); whole control frames by async_write_some()
/// Rule     octets that the kernel does not take at once are kept and sent first. Until then busy() is true and send()
///          must not be called
/// Order    frames leave in the order given
/// Fault    a socket that fails is closed, so that its reader gets an error
/// Thread   the network thread
/// Memory   the rest of one send(), and the few control frames that a WebSocket has in flight
///
/// Copies are handles of the same stream.
template <typename Next>
class FrameStream {
  public:
    using executor_type = Executor;
    using next_layer_type = Next;

    explicit FrameStream(Next next) : state_(std::make_shared<State>(std::move(next))) {}

    executor_type get_executor() { return state_->drained.get_executor(); }
    next_layer_type& next_layer() { return state_->next; }
    const next_layer_type& next_layer() const { return state_->next; }

    /// Sets the callback for each time when no octets are kept any more.
    void when_drained(std::function<void()> tell) { state_->tell = std::move(tell); }
    /// Prefetches into the cache the state that send() reads.
    void fetch() const {
        __builtin_prefetch(state_.get());
        __builtin_prefetch(&state_->next);
    }
    bool busy() const { return state_->flushing || state_->closing; }
    /// Sends whole frames, concatenated, as append_frame() makes them.
    void send(std::string_view frames);

    template <typename Buffers, typename Token>
    auto async_read_some(const Buffers& buffers, Token&& token) {
        return state_->next.async_read_some(buffers, std::forward<Token>(token));
    }
    template <typename Buffers, typename Token>
    auto async_write_some(const Buffers& buffers, Token&& token);

  private:
    /// The shared state; it lives until its last write has ended.
    struct State {
        explicit State(Next stream) : next(std::move(stream)), drained(next.get_executor()) {
            drained.expires_at(std::chrono::steady_clock::time_point::max());
        }
        bool flushing = false, closing = false;
        std::string kept;
        Next next;
        Timer drained;  ///< cancelled when drained
        std::function<void()> tell;
        error_code failure;
    };
    /// Gives frames to the kernel. @return the number of octets it took
    static std::size_t give(State& state, std::string_view frames);
    static void flush(const std::shared_ptr<State>& state);
    static Task<> flush_all(std::shared_ptr<State> state);

    std::shared_ptr<State> state_;
};

template <typename Next>
std::size_t FrameStream<Next>::give(State& state, std::string_view frames) {
    if constexpr (std::is_same_v<Next, Stream>) {
        // The handle is read each time: after a close its number may belong to another client.
        const auto given =
            ::send(state.next.socket().native_handle(), frames.data(), frames.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        return given > 0 ? static_cast<std::size_t>(given) : 0;  // flush() finds the socket's error
    } else {
        return 0;  // TLS must encrypt all output itself
    }
}

template <typename Next>
void FrameStream<Next>::send(std::string_view frames) {
    const auto given = give(*state_, frames);
    if (given == frames.size()) return;
    state_->kept += frames.substr(given);
    flush(state_);
}

template <typename Next>
void FrameStream<Next>::flush(const std::shared_ptr<State>& state) {
    if (std::exchange(state->flushing, true)) return;
    asio::co_spawn(state->drained.get_executor(), flush_all(state), asio::detached);
}

template <typename Next>
Task<> FrameStream<Next>::flush_all(std::shared_ptr<State> state) {
    while (!state->kept.empty() && !state->failure) {
        const auto octets = std::exchange(state->kept, {});
        co_await asio::async_write(state->next, asio::buffer(octets), asio::redirect_error(awaiting, state->failure));
    }
    state->closing = state->closing || state->failure;
    state->flushing = false;
    state->drained.cancel();
    if (state->failure) {
        error_code ignored;
        beast::get_lowest_layer(state->next).socket().close(ignored);
    } else if (state->tell) {
        state->tell();
    }
}

/// Takes all octets. Completes once nothing is kept, so that a WebSocket has at most one control frame of a kind in
/// flight.
template <typename Next>
template <typename Buffers, typename Token>
auto FrameStream<Next>::async_write_some(const Buffers& buffers, Token&& token) {
    constexpr char close_frame = '\x88';
    const auto octets = beast::buffers_to_string(buffers);
    state_->closing = state_->closing || octets.starts_with(close_frame);  // no data may follow it
    state_->kept += octets;
    flush(state_);
    return asio::async_compose<Token, void(error_code, std::size_t)>(
        [state = state_, size = octets.size(), first = true](auto& self, error_code = {}) mutable {
            if (std::exchange(first, false) && !state->flushing)
                // Must not complete within the initiating call.
                asio::post(state->drained.get_executor(), std::move(self));
            else if (state->flushing)
                state->drained.async_wait(std::move(self));
            else
                self.complete(state->failure, state->failure ? 0 : size);
        },
        token, state_->drained);
}

// Beast's hooks for closing the connection below a WebSocket.
template <typename Next>
void teardown(beast::role_type role, FrameStream<Next>& stream, error_code& error) {
    using beast::websocket::teardown;
    teardown(role, stream.next_layer(), error);
}
template <typename Next, typename Handler>
void async_teardown(beast::role_type role, FrameStream<Next>& stream, Handler&& handler) {
    using beast::websocket::async_teardown;
    async_teardown(role, stream.next_layer(), std::forward<Handler>(handler));
}

}  // namespace aeolis::server::net
