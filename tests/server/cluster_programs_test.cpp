// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/run.pb.h"
#include "server/archive/archive_comparison.hpp"
#include "server/archive/sqlite.hpp"
#include "server/base/json.hpp"
#include "server/cluster/engine.hpp"
#include "server/cluster/run_messages.hpp"
#include "tests/server/cluster/nats_server.hpp"
#include "tests/server/cluster/tcp_proxy.hpp"
#include "tests/server/run_copies.hpp"
#include "tests/server/web_client.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <thread>

// The programs as they are started, killed at any moment.
namespace server_cluster_programs_test {

using namespace aeolis;
using namespace aeolis::test;
using namespace std::chrono_literals;
using tests::NatsServer;

namespace {

template <typename Condition>
bool comes(Condition condition) {
    const auto until = std::chrono::steady_clock::now() + 300s;  // on a machine that builds meanwhile
    while (!condition()) {
        if (std::chrono::steady_clock::now() > until) return false;
        std::this_thread::sleep_for(20ms);
    }
    return true;
}

/// `aeolis serve`, until it is killed.
class Serving {
  public:
    Serving(std::filesystem::path archive, const std::vector<std::string>& options) : archive_(std::move(archive)) {
        start(options);
    }
    Serving(const Serving&) = delete;
    Serving& operator=(const Serving&) = delete;

    void kill() { process_.reset(); }
    void start(const std::vector<std::string>& options) {
        std::vector<std::string> words{program(),   "serve",           "--listen",    "127.0.0.1:0",
                                       "--archive", archive_.string(), "--log-level", "error"};
        words.insert(words.end(), options.begin(), options.end());
        const auto output = archive_.string() + ".out";
        std::filesystem::remove(output);
        process_.emplace(std::move(words), output);
        std::string text;
        const bool started = comes([&] {
            std::ifstream in{output};
            text.assign(std::istreambuf_iterator<char>{in}, {});
            return text.find("end with Ctrl-C") != std::string::npos || !process_->running();
        });
        INFO(text);
        REQUIRE(started);
        const auto at = text.find("http://127.0.0.1:");
        REQUIRE(at != std::string::npos);
        port_ = static_cast<std::uint16_t>(std::stoi(text.substr(at + 17)));
    }
    WebReply ask(const char* method, const std::string& path, const std::string& body = {}) const {
        return web_request(port_, method, path, body);
    }
    /// The newest run; run 0: there is none.
    v1::RunState newest() const {
        v1::RunList runs;
        const auto reply = ask("GET", "/api/v1/runs?limit=1");
        REQUIRE(reply.status == 200);
        REQUIRE(server::from_json(reply.body, runs));
        return runs.runs().empty() ? v1::RunState{} : runs.runs(0);
    }
    const std::filesystem::path& archive() const { return archive_; }
    std::uint16_t port() const { return port_; }
    /// A figure of /metrics; none: it is not told.
    std::optional<double> figure(const std::string& name) const {
        const auto text = ask("GET", "/metrics").body;
        const auto at = text.find("\naeolis_" + name + " ");
        if (at == std::string::npos) return std::nullopt;
        return std::stod(text.substr(at + name.size() + 9));
    }

  private:
    const std::filesystem::path archive_;
    std::optional<ChildProcess> process_;
    std::uint16_t port_ = 0;
};

/// Continues the newest run where it was cut off; flies another one when it has landed.
void go_on(const Serving& origin) {
    const auto run = origin.newest();
    if (run.state() == v1::RunState::running) return;
    const auto body = run.state() == v1::RunState::interrupted
                          ? fmt::format(R"({{"continue_run":{},"pace":0}})", run.run())
                          : std::string{R"({"scenario":"nominal_auto","pace":0})"};
    const auto reply = origin.ask("POST", "/api/v1/rehearsals", body);
    INFO(reply.body);
    REQUIRE(reply.status < 300);
}

/// What was received and is in the copy is in the origin, exactly.
std::uint64_t foreign_rows(const std::filesystem::path& copy, const std::filesystem::path& origin) {
    auto database = archive::sqlite::Database::open(copy.string(), archive::sqlite::Mode::read_only);
    REQUIRE(database);
    REQUIRE(database->attach_read_only(origin, "origin"));
    std::uint64_t rows = 0;
    for (const std::string table : {"packets", "tones", "command_stages", "link_changes", "situations", "events"}) {
        const auto only_here = database->integer_of(
            fmt::format("SELECT count(*) FROM (SELECT * FROM main.{0} EXCEPT SELECT * FROM origin.{0})", table)
                .c_str());
        REQUIRE(only_here);
        rows += static_cast<std::uint64_t>(*only_here);
    }
    return rows;
}

/// Whether the follower holds what the origin does, and else what differs. Nothing is compared while it says that it
/// is behind.
bool same(const Serving& origin, const Serving& follower, std::vector<std::string>& differences) {
    if (follower.figure("following_behind_items") != 0.0) return false;
    const auto compared = archive::compare(origin.archive(), follower.archive());
    if (compared) differences = compared->differences;
    return compared && compared->differences.empty();
}

void kill_programs(int kills, std::uint32_t seed) {
    TemporaryFolder folder;
    NatsServer engine;
    std::mt19937 random{seed};
    std::array order{0, 1, 2};  // each part once before any is killed again
    Serving origin{folder / "origin.db", {"--nats", engine.url(), "--scenario", "nominal_auto", "--pace", "0"}};
    REQUIRE(comes([&] {
        return origin.ask("GET", "/metrics").body.find("\naeolis_published_steps_total 0") == std::string::npos;
    }));
    Serving follower{folder / "follower.db", {"--follow", engine.url()}};
    INFO("seed " << seed);
    for (int kill = 0; kill < kills; ++kill) {
        if (kill % 3 == 0) std::shuffle(order.begin(), order.end(), random);
        go_on(origin);
        std::this_thread::sleep_for(std::chrono::milliseconds{200 + random() % 1000});
        switch (order[static_cast<std::size_t>(kill % 3)]) {
        case 0:
            origin.kill();
            origin.start({"--nats", engine.url()});
            break;
        case 1:
            follower.kill();
            follower.start({"--follow", engine.url()});
            break;
        default:
            engine.kill();
            if (random() % 2 == 0) engine.forget();
            engine.start();
        }
        CHECK(foreign_rows(follower.archive(), origin.archive()) == 0);
    }
    go_on(origin);
    CHECK(comes([&] { return origin.newest().state() == v1::RunState::finished; }));
    std::vector<std::string> differences;
    CHECK(comes([&] { return same(origin, follower, differences); }));
    INFO(fmt::format("{}", fmt::join(differences, "\n")));
    CHECK(differences.empty());
    CHECK(faults_of(follower.archive()).empty());
    // It is moved into the file at 16 MB, later where readers hold it; what is never moved is 90 MB after a landing.
    constexpr std::uintmax_t log_octets_max = 66'000'000;
    CHECK(std::filesystem::file_size(follower.archive().string() + "-wal") < log_octets_max);
    CHECK(follower.newest().outcome() == v1::Landing::touchdown);
}

}  // namespace

TEST_CASE("the program of a late follower fetches by HTTP what the engine no longer has, though it is cut and killed",
          "[cluster][R61]") {
    if (!NatsServer::present() || program().empty()) return;
    TemporaryFolder folder;
    const NatsServer engine;
    const Serving origin{folder / "origin.db", {"--nats", engine.url(), "--scenario", "nominal_auto", "--pace", "0"}};
    REQUIRE(comes([&] { return origin.newest().state() == v1::RunState::finished; }));
    REQUIRE(comes([&] { return origin.figure("publishing_waiting_items") == 0.0; }));
    server::cluster::EngineAddress address;
    address.url = engine.url();
    auto client = server::cluster::Engine::connect(address, "test");
    REQUIRE(client);
    REQUIRE(client->clear(server::cluster::run_stream, server::cluster::all_runs));
    go_on(origin);  // another run, which goes on
    tests::TcpProxy way{origin.port()};
    way.throttle(1'000'000);
    const std::vector<std::string> options{"--follow", engine.url(), "--snapshot-from",
                                           "http" + way.url().substr(way.url().find(':'))};
    Serving follower{folder / "follower.db", options};
    const auto fetches = [&] { return follower.figure("followed_fetched_steps_total").value_or(0.0) >= 1.0; };
    REQUIRE(comes(fetches));
    way.cut();
    std::this_thread::sleep_for(1s);
    CHECK(foreign_rows(follower.archive(), origin.archive()) == 0);
    way.join();
    follower.kill();
    follower.start(options);
    CHECK(comes(fetches));
    way.throttle(0);
    REQUIRE(comes([&] { return origin.newest().state() == v1::RunState::finished; }));
    std::vector<std::string> differences;
    CHECK(comes([&] { return same(origin, follower, differences); }));
    INFO(fmt::format("{}\n{}", fmt::join(differences, "\n"), follower.ask("GET", "/healthz").body));
    CHECK(differences.empty());
    CHECK(faults_of(follower.archive()).empty());
    CHECK(comes([&] { return follower.figure("following_behind_items") == 0.0; }));
    CHECK(follower.figure("following_fetch_fault") == 0.0);
    CHECK(follower.figure("followed_refused_total") == 0.0);
}

TEST_CASE("the programs of origin, engine and follower, each killed in flight, land and hold the same",
          "[cluster][R61]") {
    if (!NatsServer::present() || program().empty()) return;
    kill_programs(3, 20261127);
}

TEST_CASE("the programs of origin, engine and follower, killed at fifty moments, land and hold the same",
          "[cluster][R61][long]") {
    if (!NatsServer::present() || program().empty()) return;
    kill_programs(50, 1);
}

}  // namespace server_cluster_programs_test
