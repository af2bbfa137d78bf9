// SPDX-License-Identifier: Apache-2.0
#include "bench/loopback_clients.hpp"

#include "bench/must.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace aeolis::bench {
namespace {

constexpr std::uint64_t pong_interval_ns = 5'000'000'000;

std::uint64_t now_ns() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(time.tv_nsec);
}

void send_all(int socket, std::string_view octets) {
    must(::send(socket, octets.data(), octets.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(octets.size()), "send");
}

/// Sends the upgrade, then the subscription in one masked frame (mask 0).
void open_stream(int socket, const std::string& subscription) {
    send_all(socket, "GET /api/v1/stream HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                     "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                     "Sec-WebSocket-Protocol: aeolis.v1.protobuf\r\n\r\n");
    std::string reply;
    while (reply.find("\r\n\r\n") == std::string::npos) {
        char octet = 0;
        must(::recv(socket, &octet, 1, 0) == 1, "the upgrade");
        reply += octet;
    }
    must(reply.starts_with("HTTP/1.1 101"), reply.c_str());
    std::string frame{"\x82"};
    if (subscription.size() < 126)
        frame += static_cast<char>(0x80U | subscription.size());
    else
        frame.append({static_cast<char>(0xFE), static_cast<char>(subscription.size() >> 8U),
                      static_cast<char>(subscription.size() & 255U)});
    send_all(socket, frame + std::string(4, '\0') + subscription);
}

int connect_to(std::uint16_t port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    must(socket >= 0, "socket");
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    must(::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0, "connect");
    return socket;
}

/// Finds time stamps in the octets read; a time stamp cut by the end of a read is completed by the next one.
struct Reading {
    std::string kept;

    void take(SharedCounters& counters, std::string_view octets) {
        const auto now = now_ns();
        std::string joined;
        if (!kept.empty()) {
            joined = std::exchange(kept, {}).append(octets);
            octets = joined;
        }
        std::uint64_t found = 0;
        for (;;) {
            const auto at = octets.find(time_stamp_prefix);
            if (at == std::string_view::npos) break;
            if (octets.size() < at + time_stamp_prefix.size() + 16) break;
            std::uint64_t made_ns = 0;
            std::from_chars(octets.data() + at + time_stamp_prefix.size(),
                            octets.data() + at + time_stamp_prefix.size() + 16, made_ns, 16);
            const auto bin = std::min<std::size_t>((now - made_ns) / 50'000U, latency_bins - 1);
            counters.latencies[bin].fetch_add(1, std::memory_order_relaxed);
            ++found;
            octets.remove_prefix(at + time_stamp_prefix.size() + 16);
        }
        kept = octets.substr(octets.size() - std::min(octets.size(), time_stamp_prefix.size() + 16));
        counters.messages.fetch_add(found, std::memory_order_relaxed);
    }
};

void read_until_closed(SharedCounters& counters, int phase, const std::vector<int>& sockets, bool websocket) {
    const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
    std::vector<Reading> readings(sockets.size());
    for (std::size_t i = 0; i < sockets.size(); ++i) {
        epoll_event event{};
        event.events = EPOLLIN;
        event.data.u64 = i;
        must(::epoll_ctl(epoll, EPOLL_CTL_ADD, sockets[i], &event) == 0, "epoll_ctl");
    }
    std::array<epoll_event, 256> events{};
    std::vector<char> buffer(256 << 10);
    for (auto sent_ns = now_ns(); counters.phase == phase;) {
        if (websocket && now_ns() - sent_ns > pong_interval_ns) {
            sent_ns = now_ns();
            for (const int socket : sockets)
                (void)::send(socket, unsolicited_pong.data(), unsolicited_pong.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        }
        const int count = ::epoll_wait(epoll, events.data(), events.size(), 20);
        for (int i = 0; i < count; ++i) {
            const auto client = static_cast<std::size_t>(events[static_cast<std::size_t>(i)].data.u64);
            const auto got = ::recv(sockets[client], buffer.data(), buffer.size(), MSG_DONTWAIT);
            if (got <= 0) {
                if (got < 0 && errno == EAGAIN) continue;
                ++counters.lost_connections;
                ::epoll_ctl(epoll, EPOLL_CTL_DEL, sockets[client], nullptr);
                continue;
            }
            counters.octets.fetch_add(static_cast<std::uint64_t>(got), std::memory_order_relaxed);
            readings[client].take(counters, {buffer.data(), static_cast<std::size_t>(got)});
        }
    }
    ::close(epoll);
}

struct Order {
    std::size_t clients = 0, stalled = 0;
    bool websocket = true;
    std::uint32_t subscriptions = 0;  ///< number of those that follow, each after its size in octets
};

void read_all(int orders, void* into, std::size_t octets) {
    for (auto* at = static_cast<char*>(into); octets > 0;) {
        const auto got = ::read(orders, at, octets);
        must(got > 0, "read");
        at += got;
        octets -= static_cast<std::size_t>(got);
    }
}

std::vector<std::string> read_subscriptions(int orders, std::size_t count) {
    std::vector<std::string> subscriptions(count);
    for (auto& each : subscriptions) {
        std::uint32_t octets = 0;
        read_all(orders, &octets, sizeof octets);
        each.resize(octets);
        read_all(orders, each.data(), octets);
    }
    return subscriptions;
}

[[noreturn]] void be_clients(SharedCounters& counters, int orders) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (;;) {
        Order order;
        if (::read(orders, &order, sizeof order) != sizeof order) ::_exit(0);
        const auto subscriptions = read_subscriptions(orders, order.subscriptions);
        const int phase = counters.phase;
        std::vector<int> sockets;
        for (std::size_t i = 0; i < order.clients; ++i) {
            sockets.push_back(connect_to(counters.port));
            if (order.websocket) open_stream(sockets.back(), subscriptions[i % subscriptions.size()]);
        }
        counters.reached_phase = phase;
        read_until_closed(counters, phase,
                          {sockets.begin(), sockets.end() - static_cast<std::ptrdiff_t>(order.stalled)},
                          order.websocket);
        for (const int socket : sockets) ::close(socket);
        counters.reached_phase = phase + 1;
    }
}

}  // namespace

std::string time_stamp_now() {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(now_ns()));
    return std::string{time_stamp_prefix} + digits;
}

LoopbackClients::LoopbackClients() {
    rlimit files{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
    int ends[2];
    must(::pipe(ends) == 0, "pipe");
    process_ = fork_clients();
    if (process_ == 0) {
        ::close(ends[1]);
        be_clients(*counters_, ends[0]);
    }
    ::close(ends[0]);
    pipe_ = ends[1];
}

LoopbackClients::~LoopbackClients() {
    if (counters_->phase % 2 == 1) close();
    ::close(pipe_);
    ::waitpid(process_, nullptr, 0);
}

void LoopbackClients::connect(std::uint16_t port, const Settings& settings) {
    counters_->port = port;
    const int phase = ++counters_->phase;
    const Order order{settings.clients, settings.stalled, settings.websocket,
                      static_cast<std::uint32_t>(settings.subscriptions.size())};
    must(::write(pipe_, &order, sizeof order) == sizeof order, "write");
    for (const auto& each : settings.subscriptions) {
        const auto octets = static_cast<std::uint32_t>(each.size());
        must(::write(pipe_, &octets, sizeof octets) == sizeof octets &&
                 ::write(pipe_, each.data(), octets) == static_cast<ssize_t>(octets),
             "write");
    }
    while (counters_->reached_phase != phase) ::usleep(1000);
}

void LoopbackClients::close() {
    const int phase = ++counters_->phase;
    while (counters_->reached_phase != phase) ::usleep(1000);
}

void LoopbackClients::reset_counts() {
    counters_->messages = counters_->octets = counters_->lost_connections = 0;
    for (auto& bin : counters_->latencies) bin = 0;
}

double LoopbackClients::latency_ms(double quantile) const {
    std::uint64_t all = 0, sum = 0;
    for (const auto& bin : counters_->latencies) all += bin;
    for (std::size_t i = 0; i < latency_bins; ++i) {
        sum += counters_->latencies[i];
        if (static_cast<double>(sum) >= quantile * static_cast<double>(all)) return 0.05 * static_cast<double>(i + 1);
    }
    return 0.0;
}

}  // namespace aeolis::bench
