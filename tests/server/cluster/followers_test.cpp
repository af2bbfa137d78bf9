// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_messages.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"

#include <atomic>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <random>
#include <thread>

namespace server_cluster_followers_test {

using namespace aeolis;
using namespace aeolis::tests;

namespace {

const auto& dictionary = followed_dictionary;

}  // namespace

TEST_CASE("a follower holds what its origin holds, row by row, of runs before and after it came", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    test::record_run(origin.archive, dictionary, 1'500);
    Copy first{folder / "first.db", server.url()};
    record_slowly(origin.archive, 400, 2ms);
    Copy second{folder / "second.db", server.url()};
    test::add_note(origin.archive, RunId{1}, "the day after");
    for (auto* copy : {&first, &second}) {
        CHECK(comes([&] { return same(origin.file(), copy->file()); }));
        CHECK_FALSE(copy->gaps());
        CHECK(test::faults_of(copy->file()).empty());
        CHECK(comes([&] { return copy->follower->status().behind_items == 0; }));
        CHECK(copy->follower->status().refused == 0);
    }
    CHECK(comes([&] { return origin.publisher->status().waiting_items == 0; }));
}

TEST_CASE("an engine that is killed, with its streams or without, costs a follower nothing", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const bool forgets = GENERATE(false, true);
    test::TemporaryFolder folder;
    NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    Copy copy{folder / "copy.db", server.url()};
    test::record_run(origin.archive, dictionary, 500);
    std::thread landing{[&] { record_slowly(origin.archive, 1'000, 5ms); }};
    for (int times = 0; times < 2; ++times) {
        std::this_thread::sleep_for(60ms);
        server.kill();
        if (forgets) server.forget();
        std::this_thread::sleep_for(60ms);
        server.start();
    }
    landing.join();  // it was not held up: nothing waits for the engine
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
    CHECK_FALSE(copy.gaps());
    CHECK(test::faults_of(copy.file()).empty());
}

TEST_CASE("origin and follower that end and come back go on where they were", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    auto origin = std::make_unique<Origin>(folder / "origin.db", server.url());
    auto copy = std::make_unique<Copy>(folder / "copy.db", server.url());
    for (int turn = 0; turn < 3; ++turn) {
        record_slowly(origin->archive, 200, 1ms);
        if (turn == 0) copy.reset();
        if (turn == 1) origin.reset();
        if (!origin) origin = std::make_unique<Origin>(folder / "origin.db", server.url());
        if (!copy) copy = std::make_unique<Copy>(folder / "copy.db", server.url());
    }
    CHECK(comes([&] { return same(origin->file(), copy->file()); }));
    CHECK(origin->publisher->status().left_out.empty());
    CHECK(test::faults_of(copy->file()).empty());
}

TEST_CASE("messages that are none of the origin's are refused and counted, and the run goes on", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    Copy copy{folder / "copy.db", server.url()};
    record_slowly(origin.archive, 100, 0ms);
    REQUIRE(comes([&] { return same(origin.file(), copy.file()); }));
    auto engine = connected(server);
    const auto subject = cluster::subject_of_run(origin.identity(), RunId{1});
    v1::RunRows forged;
    forged.ParseFromString((*engine.newest(cluster::run_stream, subject))->octets);
    const auto genuine = forged;
    std::vector<std::string> messages{"", "no message \xff\xfe"};
    const auto add = [&](auto change) {
        forged = genuine;
        change(forged);
        messages.push_back(forged.SerializeAsString());
    };
    add([](auto& rows) { rows.set_archive("another"); });
    add([](auto& rows) { rows.set_dictionary(1); });
    add([](auto& rows) { rows.set_tables("of another version"); });
    add([](auto& rows) { rows.set_run(0); });
    add([](auto& rows) { rows.set_piece(rows.pieces()); });
    add([](auto& rows) {  // beyond a gap
        rows.mutable_before()->set_seq(100'000);
        rows.mutable_after()->set_seq(100'001);
    });
    add([](auto& rows) {  // no rows
        rows.mutable_after()->set_seq(100'001);
        rows.set_octets("no rows");
    });
    add([](auto& rows) { rows.mutable_after()->set_seq(rows.after().seq() + 1); });  // fewer than it says
    for (const auto& message : messages) REQUIRE(engine.publish(subject, message));
    // The gap has the stream read again, with what was refused before it.
    CHECK(comes([&] { return copy.follower->status().refused >= messages.size(); }));
    test::add_note(origin.archive, RunId{1}, "the day after");
    record_slowly(origin.archive, 100, 0ms);
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
    CHECK(copy.follower->status().left_out.empty());
    CHECK(test::faults_of(copy.file()).empty());
}

TEST_CASE("what the engine no longer has is taken from a copy of the origin's archive, without a seam",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    record_slowly(origin.archive, 100, 0ms);
    REQUIRE(
        comes([&] { return origin.publisher->status().steps > 0 && origin.publisher->status().waiting_items == 0; }));
    std::this_thread::sleep_for(100ms);
    pipeline::Pipeline pipeline{origin.archive, dictionary};
    REQUIRE(pipeline.begin({}));
    const auto go_on = [&](std::uint16_t first) {
        for (std::uint16_t count = 0; count < 100; ++count)
            REQUIRE(pipeline.accept(test::navigation(static_cast<std::uint16_t>(first + count))));
        REQUIRE(pipeline.commit());
    };
    go_on(0);
    REQUIRE(comes([&] { return origin.publisher->status().items >= 400; }));
    auto engine = connected(server);
    REQUIRE(engine.clear(cluster::run_stream, cluster::subject_of_runs(origin.identity())));
    REQUIRE(archive::backup(origin.file(), folder / "backed_up.db"));
    go_on(100);
    Copy late{folder / "late.db", server.url()}, backed_up{folder / "backed_up.db", server.url()};
    go_on(200);
    REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}));
    CHECK(comes([&] { return same(origin.file(), backed_up.file()); }));
    CHECK(test::faults_of(backed_up.file()).empty());
    CHECK(comes([&] { return !late.follower->status().left_out.empty(); }));
    CHECK_THAT(cluster::text_of(late.follower->status()), Catch::Contains("aeolis archive backup"));
}

TEST_CASE("a step of many links in many messages arrives whole, also where the engine dies within it",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    Copy copy{folder / "copy.db", server.url()};
    pipeline::Pipeline pipeline{origin.archive, dictionary};
    REQUIRE(pipeline.begin({}));
    std::mt19937 random{20261127};
    std::vector<std::uint8_t> octets(300'000);  // that are not packed into less
    for (std::uint16_t count = 0; count < 8; ++count) {
        REQUIRE(pipeline.accept(test::navigation(count)));
        for (int link = 0; link < 4; ++link) {
            for (auto& octet : octets) octet = static_cast<std::uint8_t>(random());
            REQUIRE(pipeline.accept(
                telemetry::ReceivedOctets{{fmt::format("link_{}", link), false}, Ert{1'000'000 + count}, octets}));
        }
        REQUIRE(pipeline.commit());
        if (count % 3 != 2) continue;
        server.kill();
        server.start();
    }
    REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}));
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
    CHECK(copy.follower->status().refused == 0);
    // Each of the two deaths may take the acknowledgement of a step that had arrived: it is not counted then.
    CHECK(origin.publisher->status().octets > (8 - 2) * 4 * octets.size());
}

TEST_CASE("a follower tells that its origin is silent, and that it is back", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    record_slowly(origin.archive, 100, 0ms);
    v1::RunState state;
    state.set_run(1);
    state.set_title("as its origin has it");
    origin.publisher->run_state(state);
    Copy copy{folder / "copy.db", server.url()};
    CHECK(comes([&] { return copy.state().title() == "as its origin has it"; }));
    CHECK_FALSE(copy.follower->status().lost);
    origin.publisher.reset();
    CHECK(comes([&] { return copy.follower->status().lost; }));
    CHECK_THAT(cluster::text_of(copy.follower->status()), Catch::Contains("has not been heard"));
    origin.publish(server.url());
    CHECK(comes([&] { return !copy.follower->status().lost; }));
}

TEST_CASE("an engine that is away, or is none, holds nobody up and is named", "[cluster][R61]") {
    test::TemporaryFolder folder;
    Origin origin{folder / "origin.db", "nats://someone:secret@127.0.0.1:1"};
    record_slowly(origin.archive, 100, 0ms);
    CHECK(comes(
        [&] { return !origin.publisher->status().fault.empty() && origin.publisher->status().waiting_items > 0; }));
    const auto told = cluster::text_of(origin.publisher->status());
    CHECK_THAT(told, Catch::Contains("items wait to be published") && Catch::Contains("nats://127.0.0.1:1: "));
    CHECK_THAT(told, !Catch::Contains("secret"));
    auto shared = SharedArchive::open(origin.file());
    REQUIRE(shared);
    CHECK_FALSE(cluster::begin_following(*shared, at("nats://127.0.0.1:1"), "", dictionary.id));
    if (!NatsServer::present()) return;
    const NatsServer plain{NatsServer::JetStream::absent};
    Origin without{folder / "without.db", plain.url()};
    CHECK(comes([&] { return without.publisher->status().fault.find("no JetStream") != std::string::npos; }));
}

TEST_CASE("two servers that publish one archive's runs are told apart, and the second says so", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    Origin origin{folder / "origin.db", server.url()};
    record_slowly(origin.archive, 60, 0ms);
    REQUIRE(comes([&] { return origin.publisher->status().items >= 120; }));
    REQUIRE(archive::backup(origin.file(), folder / "twin.db"));
    pipeline::Pipeline pipeline{origin.archive, dictionary};
    REQUIRE(pipeline.begin({}));
    Origin twin{folder / "twin.db", server.url()};
    pipeline::Pipeline other{twin.archive, dictionary};
    REQUIRE(other.begin({}));
    const auto told = [](const Origin& one) {
        return one.publisher->status().fault.find("another server publishes") != std::string::npos ||
               !one.publisher->status().left_out.empty();
    };
    std::uint16_t count = 0;
    CHECK(comes([&] {
        for (auto* each : {&pipeline, &other}) {
            REQUIRE(each->accept(test::navigation(count)));
            REQUIRE(each->commit());
        }
        ++count;
        return told(origin) || told(twin);
    }));
}

// ---- killed as by kill -9 ------------------------------------------------------------------------------------------

namespace {

constexpr const char* as_origin = "part of a test: an origin that is killed";
constexpr const char* as_copy = "part of a test: a follower that is killed";

void kill_at_moments(int moments, std::uint32_t seed) {
    test::TemporaryFolder folder;
    NatsServer server;
    std::mt19937 random{seed};
    const auto some = [&](int most_ms) { return std::chrono::milliseconds{random() % static_cast<unsigned>(most_ms)}; };
    const auto origin = folder / "origin.db", copy = folder / "copy.db";
    const auto part = [&](const char* name, const std::filesystem::path& file) {
        return test::ChildProcess::part(name,
                                        {{"AEOLIS_TEST_ARCHIVE", file.string()}, {"AEOLIS_TEST_ENGINE", server.url()}});
    };
    {
        auto first = part(as_origin, origin);
        REQUIRE(comes([&] { return std::filesystem::exists(origin); }));
        auto second = part(as_copy, copy);
        for (int moment = 0; moment < moments; ++moment) {
            std::this_thread::sleep_for(300ms + some(400));
            switch (random() % 3) {
            case 0:
                first.kill();
                first = part(as_origin, origin);
                break;
            case 1:
                second.kill();
                second = part(as_copy, copy);
                break;
            default:
                server.kill();
                if (random() % 2 == 0) server.forget();
                server.start();
            }
        }
    }
    Origin last{origin, server.url()};
    record_slowly(last.archive, 40, 0ms);
    Copy follower{copy, server.url()};
    INFO("seed " << seed);
    CHECK(comes([&] { return same(origin, copy); }));
    CHECK(test::faults_of(copy).empty());
    CHECK(last.publisher->status().left_out.empty());
}

}  // namespace

TEST_CASE("part of a test: an origin that is killed", "[.part]") {
    REQUIRE_FALSE(test::variable("AEOLIS_TEST_ARCHIVE").empty());
    Origin origin{test::variable("AEOLIS_TEST_ARCHIVE"), test::variable("AEOLIS_TEST_ENGINE")};
    for (;;) record_slowly(origin.archive, 300, 2ms);
}

TEST_CASE("part of a test: a follower that is killed", "[.part]") {
    REQUIRE_FALSE(test::variable("AEOLIS_TEST_ARCHIVE").empty());
    Copy copy{test::variable("AEOLIS_TEST_ARCHIVE"), test::variable("AEOLIS_TEST_ENGINE")};
    for (;;) std::this_thread::sleep_for(1s);
}

TEST_CASE("origin, follower and engine killed at any moment leave both archives the same", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    kill_at_moments(4, 20261127);
}

TEST_CASE("origin, follower and engine killed at fifty moments leave both archives the same", "[cluster][R61][long]") {
    if (!NatsServer::present()) return;
    kill_at_moments(50, GENERATE(1U, 2U, 3U));
}

}  // namespace server_cluster_followers_test
