// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_messages.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/server/cluster/tcp_proxy.hpp"
#include "tests/support/catch.hpp"

#include <fmt/format.h>
#include <optional>
#include <string>
#include <thread>

// An engine that is changed, full, slow or out of reach while runs are published and followed.
namespace server_cluster_faults_test {

using namespace aeolis;
using namespace aeolis::tests;

namespace {

/// What the engine answers to its administrator; empty: nothing, or an error.
std::string asked(Engine& engine, const std::string& what, const std::string& body = {}) {
    const auto to = Engine::own_subject();
    auto answers = engine.listen(to);
    if (!answers || !engine.send("$JS.API.STREAM." + what, body, to)) return {};
    const auto answer = answers->next(10s);
    if (!answer || !*answer || (*answer)->octets.find("\"error\"") != std::string::npos) return {};
    return (*answer)->octets;
}
void administer(Engine& engine, const std::string& what, const std::string& body = {}) {
    REQUIRE_FALSE(asked(engine, what, body).empty());
}

std::string stream_of(std::int64_t octets_max) {
    return fmt::format(R"({{"name":"{}","subjects":["{}"],"retention":"limits","storage":"file","discard":"new",)"
                       R"("max_bytes":{},"num_replicas":1,"max_consumers":-1,"max_msgs":-1}})",
                       cluster::run_stream, cluster::all_runs, octets_max);
}

void all_is_the_same(Origin& origin, Copy& copy) {
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
    CHECK_FALSE(copy.gaps());
    CHECK(test::faults_of(copy.file()).empty());
    CHECK(comes([&] { return copy.follower->status().behind_items == 0; }));
    CHECK(comes([&] { return origin.publisher->status().waiting_items == 0; }));
    CHECK(copy.follower->status().left_out.empty());
}

}  // namespace

TEST_CASE("streams that are deleted under a running system are filled again, and nothing is lost", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    Copy copy{folder / "copy.db", server.url()};
    test::record_run(origin.archive, followed_dictionary, 500);
    std::thread landing{[&] { record_slowly(origin.archive, 600, 5ms); }};
    auto engine = connected(server);
    std::this_thread::sleep_for(60ms);
    administer(engine, std::string{"DELETE."} + cluster::run_stream);
    std::this_thread::sleep_for(60ms);
    administer(engine, std::string{"DELETE."} + cluster::origin_stream);
    landing.join();
    all_is_the_same(origin, copy);
}

TEST_CASE("an engine that is full is told and waited for, and the landing goes on", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    auto engine = connected(server);
    administer(engine, std::string{"CREATE."} + cluster::run_stream, stream_of(20'000));
    Origin origin{folder / "origin.db", server.url()};
    Copy copy{folder / "copy.db", server.url()};
    record_slowly(origin.archive, 2'000, 0ms);
    CHECK(comes([&] { return origin.publisher->status().fault.find("maximum bytes exceeded") != std::string::npos; }));
    CHECK(comes([&] { return origin.publisher->status().waiting_items > 0; }));
    CHECK_FALSE(same(origin.file(), copy.file()));
    administer(engine, std::string{"UPDATE."} + cluster::run_stream, stream_of(100'000'000));
    all_is_the_same(origin, copy);
    CHECK(origin.publisher->status().fault.empty());
}

namespace {

/// The network of the origin, or of its follower, as `change` has it while a run is recorded.
template <typename Change>
void with_network(bool of_origin, Change change) {
    test::TemporaryFolder folder;
    const NatsServer server;
    TcpProxy network{server.port()};
    Origin origin{folder / "origin.db", of_origin ? network.url() : server.url()};
    Copy copy{folder / "copy.db", of_origin ? server.url() : network.url()};
    test::record_run(origin.archive, followed_dictionary, 500);
    std::thread landing{[&] { record_slowly(origin.archive, 400, 5ms); }};
    change(network, origin, copy);
    landing.join();
    all_is_the_same(origin, copy);
}

}  // namespace

TEST_CASE("a slow network delays followers and loses nothing", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    with_network(GENERATE(true, false), [](TcpProxy& network, Origin&, Copy&) {
        network.throttle(40'000);
        std::this_thread::sleep_for(500ms);
        network.throttle(0);
    });
}

TEST_CASE("a network that is cut, or holds everything back, is told as such and loses nothing", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const bool of_origin = GENERATE(true, false), closes = GENERATE(true, false);
    with_network(of_origin, [&](TcpProxy& network, Origin& origin, Copy& copy) {
        std::this_thread::sleep_for(50ms);
        closes ? network.cut() : network.hold(true);
        const auto told = [&] {
            return of_origin ? !origin.publisher->status().fault.empty() : !copy.follower->status().fault.empty();
        };
        CHECK(comes([&] { return told() || copy.follower->status().lost; }));
        closes ? network.join() : network.hold(false);
        CHECK(comes([&] { return !told() && !copy.follower->status().lost; }));
    });
}

TEST_CASE("a network that is cut for a minute loses nothing", "[cluster][R61][long]") {
    if (!NatsServer::present()) return;
    const bool of_origin = GENERATE(true, false);
    with_network(of_origin, [&](TcpProxy& network, Origin&, Copy& copy) {
        network.cut();
        std::this_thread::sleep_for(60s);
        CHECK(copy.follower->status().lost);
        network.join();
    });
}

namespace {

/// The engine that leads a stream; none: the engines have not agreed on one for a minute.
std::optional<std::size_t> leader_of(Engine& engine, const char* stream) {
    std::optional<std::size_t> leader;
    comes([&] {
        const auto told = asked(engine, std::string{"INFO."} + stream);
        for (std::size_t each = 0; each < NatsCluster::engines; ++each)
            if (told.find(fmt::format(R"("leader":"{}")", NatsCluster::name_of(each))) != std::string::npos)
                leader = each;
        return leader.has_value();
    });
    return leader;
}

/// Whether a stream is led, and both its other engines hold all of it.
bool caught_up(Engine& engine, const char* stream) {
    const auto told = asked(engine, std::string{"INFO."} + stream);
    std::size_t current = 0;
    for (std::size_t at = 0; (at = told.find(R"("current":true)", at)) != std::string::npos; ++at) ++current;
    return current + 1 == NatsCluster::engines;
}

/// Three engines, of which the leader of each of these streams is killed in turn and comes back.
void lose_leaders(std::initializer_list<const char*> streams) {
    test::TemporaryFolder folder;
    NatsCluster engines;
    auto engine = Engine::connect(at(engines.url()), "administrator");
    REQUIRE(engine);
    Origin origin{folder / "origin.db", engines.url()};
    Copy copy{folder / "copy.db", engines.url()};
    test::record_run(origin.archive, followed_dictionary, 500);
    for (const auto* stream : streams) {
        const auto leader = leader_of(*engine, stream);
        REQUIRE(leader.has_value());
        engines.at(*leader).kill();
        record_slowly(origin.archive, 200, 1ms);  // it is not held up: nothing waits for the engines
        all_is_the_same(origin, copy);
        if (streams.size() == 1) return;
        engines.at(*leader).start();
        // Until three have the streams again: of two that are left none may be killed.
        for (const auto* each : {cluster::run_stream, cluster::origin_stream})
            REQUIRE(comes([&] { return caught_up(*engine, each); }));
    }
}

}  // namespace

TEST_CASE("three engines with replicas lose the leader of the stream, and nothing else", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    lose_leaders({cluster::run_stream});
}

TEST_CASE("three engines with replicas lose the leaders of their streams one after another, and nothing else",
          "[cluster][R61][long]") {
    if (!NatsServer::present()) return;
    lose_leaders({cluster::run_stream, cluster::origin_stream, cluster::run_stream, cluster::origin_stream});
}

}  // namespace server_cluster_faults_test
