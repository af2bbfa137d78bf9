// SPDX-License-Identifier: Apache-2.0
#include "tests/server/cluster/tcp_proxy.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <list>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace aeolis::tests {
namespace {

constexpr std::size_t buffer_octets = 64U << 10U;
constexpr std::chrono::milliseconds turn{2};

sockaddr_in loopback_port(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

int socket_without_waits() {
    return ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

}  // namespace

/// Octets on their way from one socket to another.
struct TcpProxy::Way {
    int from = -1, to = -1;
    std::vector<char> octets{};

    /// False: an end was closed.
    bool pass(std::size_t most) {
        std::array<char, buffer_octets> part{};
        if (octets.size() < buffer_octets) {
            const auto got = ::recv(from, part.data(), std::min(most, part.size()), 0);
            if (got == 0 || (got < 0 && errno != EAGAIN)) return false;
            if (got > 0) octets.insert(octets.end(), part.data(), part.data() + got);
        }
        if (octets.empty()) return true;
        const auto sent = ::send(to, octets.data(), std::min(most, octets.size()), MSG_NOSIGNAL);
        if (sent < 0 && errno != EAGAIN) return false;
        if (sent > 0) octets.erase(octets.begin(), octets.begin() + sent);
        return true;
    }
};

struct TcpProxy::Pair {
    Way up, down;
    ~Pair() {
        ::close(up.from);
        ::close(up.to);
    }
};

TcpProxy::TcpProxy(std::uint16_t to) : to_(to), listens_(socket_without_waits()) {
    auto address = loopback_port(0);
    socklen_t size = sizeof address;
    if (::bind(listens_, reinterpret_cast<const sockaddr*>(&address), size) != 0 || ::listen(listens_, 16) != 0 ||
        ::getsockname(listens_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
        throw std::runtime_error("no port is free");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread{[this] { run(); }};
}

TcpProxy::~TcpProxy() {
    stop_ = true;
    thread_.join();
    ::close(listens_);
}

std::string TcpProxy::url() const {
    return "nats://127.0.0.1:" + std::to_string(port_);
}

void TcpProxy::run() {
    std::list<Pair> pairs;
    while (!stop_) {
        // While it passes nothing limits it but the sockets: then it waits for them.
        std::vector<pollfd> waits{{listens_, POLLIN, 0}};
        for (const auto& pair : pairs)
            for (const int one : {pair.up.from, pair.up.to}) waits.push_back({one, POLLIN, 0});
        const bool free = octets_per_s_ == 0 && !held_;
        ::poll(waits.data(), free ? waits.size() : 0, static_cast<int>(turn.count()));
        const int came = ::accept4(listens_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (cut_) {
            if (came >= 0) ::close(came);
            pairs.clear();
            continue;
        }
        if (came >= 0) {
            const int on = socket_without_waits();
            const auto address = loopback_port(to_);
            ::connect(on, reinterpret_cast<const sockaddr*>(&address), sizeof address);
            pairs.emplace_back(Way{came, on}, Way{on, came});
        }
        if (held_) continue;
        const auto limit = octets_per_s_.load();
        const auto most = limit == 0 ? buffer_octets : std::max<std::size_t>(limit * turn.count() / 1000, 1);
        std::erase_if(pairs, [most](Pair& pair) { return !pair.up.pass(most) || !pair.down.pass(most); });
    }
}

}  // namespace aeolis::tests
