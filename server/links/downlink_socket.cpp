// SPDX-License-Identifier: Apache-2.0
#include "server/links/downlink_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace aeolis::server {
namespace {

// // Chosen: buffers datagrams while the disk is slow; the kernel may give less
constexpr int udp_buffer_octets = 4 << 20;

std::string words_of_error(int error) {
    return std::generic_category().message(error);
}

enum class Woken : std::uint8_t { ready, time_over, asked };

Woken wait_for(int socket, short events, int wake, std::chrono::milliseconds limit) {
    std::array<pollfd, 2> watched{{{wake, POLLIN, 0}, {socket, events, 0}}};
    int ready = 0;
    do {
        ready = ::poll(watched.data(), socket < 0 ? 1 : 2, static_cast<int>(limit.count()));
    } while (ready < 0 && errno == EINTR);
    if (watched[0].revents != 0) return Woken::asked;
    return ready > 0 ? Woken::ready : Woken::time_over;
}

}  // namespace

DownlinkSocket::DownlinkSocket() : wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

DownlinkSocket::~DownlinkSocket() {
    close();
    if (wake_ >= 0) ::close(wake_);
}

void DownlinkSocket::close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
}

Result<void> DownlinkSocket::open(const DownlinkAddress& address, std::chrono::milliseconds limit) {
    close();
    addrinfo wanted{};
    wanted.ai_socktype = address.udp ? SOCK_DGRAM : SOCK_STREAM;
    wanted.ai_flags = address.udp ? AI_PASSIVE : 0;
    addrinfo* listed = nullptr;
    const int unknown = ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wanted, &listed);
    if (unknown != 0) return Error{address.text() + ": " + ::gai_strerror(unknown)};
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all{listed, &::freeaddrinfo};
    int error = 0;
    for (const addrinfo* each = listed; each != nullptr; each = each->ai_next) {
        socket_ = ::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, each->ai_protocol);
        if (socket_ < 0) {
            error = errno;
            continue;
        }
        if (address.udp) {
            (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &udp_buffer_octets, sizeof udp_buffer_octets);
            if (::bind(socket_, each->ai_addr, each->ai_addrlen) == 0) return {};
            error = errno;
        } else {
            error = ::connect(socket_, each->ai_addr, each->ai_addrlen) == 0 ? 0 : errno;
            if (error == EINPROGRESS) {
                socklen_t size = sizeof error;
                const auto woken = wait_for(socket_, POLLOUT, wake_, limit);
                if (woken != Woken::ready)
                    error = woken == Woken::asked ? ECANCELED : ETIMEDOUT;
                else if (::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
                    error = errno;
            }
            if (error == 0) return {};
        }
        close();
    }
    return Error{address.text() + ": " + words_of_error(error)};
}

std::uint16_t DownlinkSocket::local_port() const {
    sockaddr_storage local{};
    socklen_t size = sizeof local;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the sockets' own way
    if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&local), &size) != 0) return 0;
    in_port_t port = 0;  // at the same offset in both families
    std::memcpy(&port, reinterpret_cast<const char*>(&local) + offsetof(sockaddr_in, sin_port),
                sizeof port);  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
    return ntohs(port);
}

DownlinkSocket::Received DownlinkSocket::receive(std::span<std::uint8_t> into, std::chrono::milliseconds limit) {
    switch (wait_for(socket_, POLLIN, wake_, limit)) {
    case Woken::asked: return {Got::woken, 0, {}};
    case Woken::time_over: return {Got::nothing, 0, {}};
    case Woken::ready: break;
    }
    const auto octets = ::recv(socket_, into.data(), into.size(), 0);
    if (octets > 0) return {Got::octets, static_cast<std::size_t>(octets), {}};
    if (octets < 0 && (errno == EAGAIN || errno == EINTR)) return {Got::nothing, 0, {}};
    int kind = 0;
    socklen_t size = sizeof kind;
    (void)::getsockopt(socket_, SOL_SOCKET, SO_TYPE, &kind, &size);
    if (octets == 0 && kind == SOCK_DGRAM) return {Got::nothing, 0, {}};  // an empty datagram
    return {Got::end, 0, octets == 0 ? "closed by the other side" : words_of_error(errno)};
}

bool DownlinkSocket::sleep(std::chrono::milliseconds time) const {
    return wait_for(-1, 0, wake_, time) == Woken::asked;
}

void DownlinkSocket::wake() const {
    (void)::eventfd_write(wake_, 1);
}

}  // namespace aeolis::server
