// What it costs to give one message to a thousand clients of the stream, against a bare send of the same octets to as many
// sockets: CPU a delivered message, and how long it is on its way. Then eight messages a tick.

#include "bench/loopback_clients.hpp"
#include "server/net/web_server.hpp"

#include <arpa/inet.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <netinet/tcp.h>
#include <pthread.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

using namespace aeolis;
using namespace aeolis::bench;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t clients = 1000;
constexpr double messages_per_s = 64.0, seconds = 4.0;
constexpr std::size_t message_octets = 300;
constexpr int rounds = 3; // by turns, the best of each: the machine is shared

void must(bool done, const char* what) {
    if (done) return;
    std::fprintf(stderr, "fan_out_bench: %s failed\n", what);
    std::exit(1);
}

double cpu_s(clockid_t clock) {
    timespec time{};
    ::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Figures {
    double cpu_us = 1e9, p50_ms = 1e9, p99_ms = 1e9;
    void better(const Figures& other) {
        cpu_us = std::min(cpu_us, other.cpu_us);
        p50_ms = std::min(p50_ms, other.p50_ms);
        p99_ms = std::min(p99_ms, other.p99_ms);
    }
};

/// `give` is called `ticks_per_s` times a second.
template <typename Give>
void tick(double ticks_per_s, Give give) {
    const auto begin = Clock::now();
    for (int i = 0; i < static_cast<int>(seconds * ticks_per_s); ++i) {
        std::this_thread::sleep_until(begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{i / ticks_per_s}));
        give();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{300});
}

Figures figures(const LoopbackClients& all, double cpu, double expected) {
    must(all.broken() == 0 && static_cast<double>(all.messages()) == expected, "the delivery of every message");
    return {1e6 * cpu / expected, all.latency_ms(0.5), all.latency_ms(0.99)};
}

/// The limit: one thread, one send a socket.
Figures bare(LoopbackClients& all) {
    const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    must(::bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 && ::listen(listener, 4096) == 0, "listen");
    socklen_t size = sizeof address;
    must(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0, "getsockname");
    all.connect(ntohs(address.sin_port), {clients, 0, false, ""});
    std::vector<int> sockets;
    for (std::size_t i = 0; i < clients; ++i) {
        sockets.push_back(::accept(listener, nullptr, nullptr));
        const int on = 1;
        must(sockets.back() >= 0 && ::setsockopt(sockets.back(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) == 0, "accept");
    }
    all.forget();
    const double before = cpu_s(CLOCK_THREAD_CPUTIME_ID);
    tick(messages_per_s, [&] {
        auto message = mark_now();
        message.resize(message_octets + 4, '.'); // with a frame's header
        for (const int socket : sockets)
            must(::send(socket, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(message.size()), "send");
    });
    const auto result = figures(all, cpu_s(CLOCK_THREAD_CPUTIME_ID) - before, clients * messages_per_s * seconds);
    all.close();
    for (const int socket : sockets)
        ::close(socket);
    ::close(listener);
    return result;
}

/// The server's own network thread, with every client subscribed to everything.
class Server {
  public:
    Server() {
        server::StreamHub::Services services;
        services.want_items = [](bool) {};
        hub_ = std::make_unique<server::StreamHub>(std::uint16_t{1}, services);
        v1::RunState state;
        state.set_run(1);
        hub_->run_state(state);
        server::WebServer::Handlers handlers;
        handlers.admit_stream = [](const server::Credentials&) { return server::HttpResponse{}; };
        handlers.open_stream = [this](const server::Credentials&, server::StreamFormat format, std::function<void()> wake) {
            return std::make_shared<server::StreamSession>(*hub_, format, std::move(wake), server::StreamSession::follower());
        };
        auto opened = server::WebServer::open({}, handlers);
        must(opened.ok(), "WebServer::open");
        server_ = std::move(*opened);
        thread_ = std::thread{[this] { server_->run(); }};
        must(::pthread_getcpuclockid(thread_.native_handle(), &clock_) == 0, "pthread_getcpuclockid");
    }
    ~Server() {
        server_->stop();
        thread_.join();
        server_.reset();
    }
    std::uint16_t port() const { return server_->port(); }
    double cpu() const { return cpu_s(clock_); }

    /// `count` batches of one event that is message_octets long on the wire, as the pipeline publishes them.
    void publish(std::size_t count) {
        std::vector<std::shared_ptr<const pipeline::PublishedBatch>> batches;
        for (std::size_t i = 0; i < count; ++i) {
            auto batch = std::make_shared<pipeline::PublishedBatch>();
            batch->run = archive::RunId{1};
            batch->first_seq = batch->last_seq = ++seq_;
            v1::Item item;
            item.set_seq(seq_);
            auto text = mark_now();
            text.resize(message_octets - 32, '.');
            item.mutable_event()->set_text(text);
            batch->items = {item};
            batches.push_back(std::move(batch));
        }
        server_->post([this, batches = std::move(batches)] {
            for (const auto& batch : batches)
                hub_->published(batch);
        });
    }

  private:
    std::unique_ptr<server::StreamHub> hub_;
    std::unique_ptr<server::WebServer> server_;
    std::thread thread_;
    clockid_t clock_{};
    archive::Sequence seq_ = 0;
};

Figures served(LoopbackClients& all, std::size_t a_tick) {
    Server server;
    v1::ClientMessage subscription;
    subscription.mutable_subscribe()->set_all_channels(true);
    all.connect(server.port(), {clients, 0, true, subscription.SerializeAsString()});
    std::this_thread::sleep_for(std::chrono::milliseconds{300});
    all.forget();
    const double before = server.cpu();
    tick(messages_per_s / static_cast<double>(a_tick), [&] { server.publish(a_tick); });
    const auto result = figures(all, server.cpu() - before, clients * messages_per_s * seconds);
    all.close();
    return result;
}

} // namespace

int main() {
    LoopbackClients all;
    Figures limit, ours, eight;
    for (int i = 0; i < rounds; ++i) {
        limit.better(bare(all));
        ours.better(served(all, 1));
        eight.better(served(all, 8));
    }
    std::printf("%zu clients over loopback, %.0f messages/s of %zu octets to each\n", clients, messages_per_s, message_octets);
    std::printf("  limit, bare send    %6.2f us of CPU a message, on its way p50 %.2f ms, p99 %.2f ms\n", limit.cpu_us, limit.p50_ms, limit.p99_ms);
    bool met = true;
    const auto goal = [&](const char* what, double figure, double bound, double most) {
        std::printf("  %-40s %6.2f, ratio %.2f (goal %.2f)\n", what, figure, figure / bound, most);
        met = met && figure <= most * bound;
    };
    goal("stream, us of CPU a message", ours.cpu_us, limit.cpu_us, 1.15);
    goal("stream, p50 ms", ours.p50_ms, limit.p50_ms, 1.2);
    goal("stream, p99 ms", ours.p99_ms, limit.p99_ms, 1.5);
    goal("stream, 8 a tick, us of CPU a message", eight.cpu_us, limit.cpu_us, 0.25);
    return met ? 0 : 1;
}
