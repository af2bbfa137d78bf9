// SPDX-License-Identifier: Apache-2.0
#include "tests/server/cluster/nats_server.hpp"

#include <arpa/inet.h>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <netinet/in.h>
#include <stdexcept>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace aeolis::tests {
namespace {

std::string program() {
    return test::variable("AEOLIS_NATS_SERVER");
}

sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

bool answers(std::uint16_t port) {
    const int one = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto address = loopback(port);
    sockaddr_in own{};
    socklen_t size = sizeof own;
    const bool connected = ::connect(one, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                           ::getsockname(one, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
                           own.sin_port != address.sin_port;  // a port that nobody has may be connected to itself
    ::close(one);
    return connected;
}

}  // namespace

bool NatsServer::present() {
    if (!program().empty()) return true;
    std::cout << "SKIPPED: AEOLIS_NATS_SERVER names no nats-server (./test unpacks one)\n";
    return false;
}

std::uint16_t NatsServer::free_port() {
    const int one = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    auto address = loopback(0);
    socklen_t size = sizeof address;
    const bool bound = ::bind(one, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                       ::getsockname(one, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    ::close(one);
    if (!bound) throw std::runtime_error("no port is free");
    return ntohs(address.sin_port);
}

NatsServer::NatsServer(std::vector<std::string> options)
    : streams_(JetStream::present), options_(std::move(options)), port_(free_port()) {
    start();
}

NatsServer::NatsServer(JetStream streams) : streams_(streams), port_(free_port()) {
    start();
}

std::string NatsServer::url() const {
    return "nats://127.0.0.1:" + std::to_string(port_);
}

void NatsServer::start() {
    const auto file = program();
    const auto port = std::to_string(port_);
    const auto store = (folder_.path() / "streams").string();
    std::vector<std::string> words{file, "-a", "127.0.0.1", "-p", port, "-sd", store};
    if (streams_ == JetStream::present) words.emplace_back("-js");
    words.insert(words.end(), options_.begin(), options_.end());
    process_.emplace(std::move(words));
    for (int tries = 0; tries < 3000 && process_->running(); ++tries) {
        if (answers(port_)) return;
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    throw std::runtime_error(file + " does not answer");
}

void NatsServer::kill() {
    process_.reset();
}

void NatsServer::forget() {
    std::filesystem::remove_all(folder_.path() / "streams");
}

NatsCluster::NatsCluster() {
    std::vector<std::string> routes;
    for (std::size_t engine = 0; engine < engines; ++engine)
        routes.push_back("nats://127.0.0.1:" + std::to_string(NatsServer::free_port()));
    const auto all = routes[0] + ',' + routes[1] + ',' + routes[2];
    for (std::size_t engine = 0; engine < engines; ++engine)
        servers_.push_back(std::make_unique<NatsServer>(std::vector<std::string>{
            "-n", name_of(engine), "--cluster_name", "test", "--cluster", routes[engine], "--routes", all}));
}

std::string NatsCluster::url() const {
    std::string all;
    for (const auto& server : servers_) all += (all.empty() ? "" : ",") + server->url();
    return all;
}

}  // namespace aeolis::tests
