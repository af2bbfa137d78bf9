// SPDX-License-Identifier: Apache-2.0
// A crowd of clients that join, read, stall, leave and send rubbish, while some follow the landing.
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <fmt/format.h>
#include <fstream>
#include <random>
#include <sys/resource.h>
#include <sys/socket.h>

namespace server_soak_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

using Clock = std::chrono::steady_clock;

constexpr archive::Sequence enough_items = 100;

#ifdef __SANITIZE_ADDRESS__
constexpr double growth_mb_max = 400.0;  // what was freed is kept back: 256 MB, and as much again in its shadow
#else
constexpr double growth_mb_max = 64.0;  // the landing's own recording grows meanwhile
#endif

double resident_mb() {
    std::ifstream statm{"/proc/self/statm"};
    double size = 0.0, resident = 0.0;
    statm >> size >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

/// A client's frame of at most 125 octets, masked by zeroes.
std::string frame(char first, const std::string& payload) {
    return std::string{first} + static_cast<char>(0x80U | payload.size()) + std::string(4, '\0') + payload;
}

class Member {
  public:
    enum class Kind : std::uint8_t {
        reads,
        stalls,
        leaves,
        rubbish_octets,
        rubbish_frames,
        rubbish_messages,
        half_a_request,
        kinds
    };

    /// Does what is next; when its time is over it is another client.
    void visit(std::uint16_t port, std::mt19937_64& random) {
        if (socket_ < 0) return join(port, random);
        if (Clock::now() > until_) return leave(random() % 2 == 0);
        switch (kind_) {
        case Kind::reads: hear(); break;
        case Kind::stalls:
            if (!subscribed_) hear();
            break;
        case Kind::leaves:
            hear();
            if (subscribed_) leave(true);
            break;
        case Kind::rubbish_octets:
            say(octets(random, 1 + random() % 400));
            hear();
            break;
        case Kind::rubbish_frames:
            hear();
            if (subscribed_) say(octets(random, 1 + random() % 60));
            break;
        case Kind::rubbish_messages:
            if (!subscribed_) hear();
            for (int i = 0; i < 8 && subscribed_; ++i)
                say(frame(static_cast<char>(0x82), octets(random, random() % 60)));
            break;
        default: break;
        }
    }
    void leave(bool abruptly) {
        const linger at_once{1, 0};
        if (abruptly) ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        if (socket_ >= 0) ::close(socket_);
        socket_ = -1;
    }

  private:
    static std::string octets(std::mt19937_64& random, std::size_t count) {
        std::string made(count, '\0');
        for (auto& octet : made) octet = static_cast<char>(random());
        return made;
    }
    void say(const std::string& text) {
        if (::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0 && errno != EAGAIN) leave(false);
    }
    void hear() {
        static thread_local std::string buffer(1 << 16, '\0');
        const auto got = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
        if (got == 0 || (got < 0 && errno != EAGAIN)) return leave(false);
        if (got <= 0 || subscribed_ || kind_ == Kind::rubbish_octets) return;
        subscribed_ = true;
        v1::ClientMessage message;
        message.mutable_subscribe()->set_all_channels(true);
        say(frame(static_cast<char>(0x82), message.SerializeAsString()));
    }
    void join(std::uint16_t port, std::mt19937_64& random) {
        socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (socket_ < 0 || ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
            return leave(false);
        kind_ = static_cast<Kind>(random() % static_cast<unsigned>(Kind::kinds));
        until_ = Clock::now() + std::chrono::milliseconds{100 + random() % (kind_ == Kind::stalls ? 15'000 : 4'000)};
        subscribed_ = false;
        if (kind_ == Kind::rubbish_octets) return;
        say(kind_ == Kind::half_a_request
                ? "GET /api/v1/runs HTTP/1.1\r\nHost: loc"
                : "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                  "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                  "Sec-WebSocket-Protocol: aeolis.v1.protobuf\r\n\r\n");
    }

    int socket_ = -1;
    Kind kind_{};
    bool subscribed_ = false;
    Clock::time_point until_;
};

std::string metric(std::uint16_t port, const std::string& name) {
    const auto text = web_request(port, "GET", "/metrics").body;
    const auto at = text.find("\naeolis_" + name + " ");
    return at == std::string::npos ? "none"
                                   : text.substr(at + 9 + name.size(), text.find('\n', at + 1) - at - 9 - name.size());
}

/// A client that follows the landing to the end, in a thread of its own, and holds each message to the one before.
class Follower {
  public:
    Follower(std::uint16_t port, const char* name, const v1::Subscribe& subscribe)
        : name_(name),
          every_item_(subscribe.all_channels() && subscribe.max_rate_hz() == 0.0 && !subscribe.without_units()),
          client_(port, "aeolis.v1.protobuf") {
        REQUIRE(client_.open());
        v1::ClientMessage message;
        *message.mutable_subscribe() = subscribe;
        client_.send(message.SerializeAsString(), true);
    }
    void follow(const std::atomic<bool>& over) {
        thread_ = std::thread{[this, &over] {
            while (!over && wrong_.empty()) take(client_.receive());
        }};
    }
    void join() { thread_.join(); }
    /// Empty: it got all that it had asked for.
    std::string wrong() const { return wrong_.empty() ? "" : std::string{name_} + ": " + wrong_; }
    archive::Sequence last() const { return last_; }  ///< also while it follows

  private:
    void take(const std::optional<std::string>& payload) {
        v1::ServerMessage message;
        if (!payload || !message.ParseFromString(*payload)) return void(wrong_ = "it was cut off");
        if (message.has_refusal()) wrong_ = message.refusal().reason();
        if (!message.has_batch()) return;
        const auto& batch = message.batch();
        const archive::Sequence last = last_;
        if (batch.after_seq() != last) wrong_ = fmt::format("what follows {} came after {}", batch.after_seq(), last);
        for (int i = 0; i < batch.items_size() && every_item_; ++i)
            if (batch.items(i).seq() != last + 1 + static_cast<unsigned>(i))
                wrong_ = fmt::format("item {} is in the place of {}", batch.items(i).seq(),
                                     last + 1 + static_cast<unsigned>(i));
        last_ = batch.complete_through();
    }

    const char* name_;
    bool every_item_;
    StreamClient client_;
    std::atomic<archive::Sequence> last_ = 0;
    std::string wrong_;
    std::thread thread_;
};

std::vector<std::unique_ptr<Follower>> followers(std::uint16_t port) {
    std::vector<std::unique_ptr<Follower>> all;
    v1::Subscribe everything;
    everything.set_all_channels(true);
    all.push_back(std::make_unique<Follower>(port, "who wants everything", everything));
    all.push_back(std::make_unique<Follower>(port, "another who does", everything));
    auto thinned = everything;
    thinned.set_max_rate_hz(4.0);
    thinned.set_without_units(true);
    all.push_back(std::make_unique<Follower>(port, "who wants samples at 4 Hz", thinned));
    all.push_back(std::make_unique<Follower>(port, "who wants no samples", v1::Subscribe{}));
    return all;
}

void soak(std::size_t clients, std::chrono::seconds duration, double pace) {
    rlimit files{};  // the server's sockets and the crowd's are in one process
    ::getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 600.0;
    scenario.commands[0].send_before_entry_s = 595.0;
    scenario.commands[1].send_before_entry_s = 590.0;
    RunningServer server{scenario, pace};
    const auto followed = followers(server.port());

    std::atomic<bool> over{false}, enough{false};
    for (const auto& follower : followed) follower->follow(enough);
    std::thread crowd{[&] {
        std::mt19937_64 random{1};
        std::vector<Member> members(clients);
        while (!over) {
            for (auto& member : members) member.visit(server.port(), random);
            std::this_thread::sleep_for(std::chrono::milliseconds{20});
        }
        for (auto& member : members) member.leave(true);
    }};
    std::this_thread::sleep_for(duration / 3);
    const double early_mb = resident_mb();
    std::this_thread::sleep_for(duration - duration / 3);
    const double late_mb = resident_mb();
    for (int i = 0; i < 600 && followed.front()->last() <= enough_items;
         ++i)  // a machine under load takes longer until the run begins
        std::this_thread::sleep_for(std::chrono::milliseconds{100});
    enough = true;
    for (const auto& follower : followed) follower->join();
    over = true;
    crowd.join();
    const auto last = followed.front()->last();
    CHECK(last > enough_items);
    for (const auto& follower : followed) {
        CHECK(follower->wrong() == "");
        CHECK(follower->last() + 2'000 > last);  // none was kept behind
    }
    INFO("resident: " << early_mb << " MB after a third, " << late_mb << " MB in the end");
    CHECK(late_mb - early_mb < growth_mb_max);
    CHECK(web_request(server.port(), "GET", "/healthz").status == 200);
    const auto left = std::to_string(followed.size());
    for (int i = 0; i < 3000 && metric(server.port(), "stream_clients") != left; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{100});
    CHECK(metric(server.port(), "stream_clients") == left);  // those who followed
    WARN(clients << " clients at a time, " << last << " items followed, resident " << early_mb << " MB, then "
                 << late_mb << " MB");
}

}  // namespace

TEST_CASE("clients that join, stall, leave and send rubbish cost others nothing, and leave nothing behind",
          "[stream][soak]") {
    soak(100, std::chrono::seconds{10}, 20.0);
}

TEST_CASE("ten minutes of a thousand clients that join, stall, leave and send rubbish", "[.long][stream][soak]") {
    soak(990, std::chrono::seconds{600}, 1.0);
}

}  // namespace server_soak_test
