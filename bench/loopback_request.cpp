// SPDX-License-Identifier: Apache-2.0
#include "bench/loopback_request.hpp"

#include "bench/must.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cstdlib>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace aeolis::bench {

Answered answer_of(std::uint16_t port, const std::string& request) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    must(::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0, "connect");
    must(::send(socket, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size()), "send");
    Answered answered;
    std::string head;
    std::array<char, 64 << 10> buffer{};
    for (ssize_t got = 0; (got = ::recv(socket, buffer.data(), buffer.size(), 0)) > 0;) {
        if (head.size() < 12) head.append(buffer.data(), static_cast<std::size_t>(std::min<ssize_t>(got, 12)));
        answered.octets += static_cast<std::uint64_t>(got);
    }
    ::close(socket);
    if (head.starts_with("HTTP/1.1 ")) answered.status = std::atoi(head.c_str() + 9);
    return answered;
}

std::string request_text(const std::string& method, const std::string& target, const std::string& token,
                         const std::string& body) {
    std::string text = method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer " + token +
                       "\r\nConnection: close\r\n";
    if (!body.empty())
        text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
    return text + "\r\n" + body;
}

}  // namespace aeolis::bench
