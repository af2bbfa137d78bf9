// SPDX-License-Identifier: Apache-2.0
#include "tests/server/cluster/nats_server.hpp"

#include <arpa/inet.h>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <netinet/in.h>
#include <stdexcept>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace aeolis::tests {
namespace {

std::string program() {
    const char* named = std::getenv("AEOLIS_NATS_SERVER");
    return named != nullptr ? named : "";
}

sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

bool answers(std::uint16_t port) {
    const int one = ::socket(AF_INET, SOCK_STREAM, 0);
    const auto address = loopback(port);
    const bool connected = ::connect(one, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
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
    const int one = ::socket(AF_INET, SOCK_STREAM, 0);
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

NatsServer::~NatsServer() {
    kill();
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
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
        const int nothing = ::open("/dev/null", O_RDWR);
        for (const int stream : {0, 1, 2}) ::dup2(nothing, stream);
        ::execv(file.c_str(), arguments.data());
        ::_exit(127);
    }
    for (int tries = 0; tries < 3000; ++tries) {
        if (answers(port_)) return;
        if (::waitpid(process_, nullptr, WNOHANG) == process_) break;
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    throw std::runtime_error(file + " does not answer");
}

void NatsServer::kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
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
