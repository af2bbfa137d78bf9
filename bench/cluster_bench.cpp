// SPDX-License-Identifier: Apache-2.0
// Publishing and following on loopback, against a bare publisher of the same messages. AEOLIS_NATS_SERVER names the
// engine's program.
//
//   archive     a landing (nominal_auto), flown once; its steps are what travels
//   bare        the same messages given to the engine without waiting for each (JetStream's asynchronous publishing)
//   publisher   the archive published from its beginning: read, packed, and each step behind the one before it
//   follower    the stream taken from its beginning into an archive of its own, against the time that the landing took
//   lag         2 000 packets/s, committed each 10 ms: from a commit to its items being durable at a follower and given
//               on to its streams
//   goals       publisher at 0.5 of the bare one's rate; follower at 50 times real time; lag at 100 ms, 99th percentile
#include "aeolis/v1/cluster.pb.h"
#include "bench/must.hpp"
#include "server/archive/archive.hpp"
#include "server/archive/shared_archive.hpp"
#include "server/cluster/engine.hpp"
#include "server/cluster/follower.hpp"
#include "server/cluster/publisher.hpp"
#include "server/cluster/run_messages.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/cluster/nats_server.hpp"
#include "tests/server/run_copies.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

namespace {

using namespace aeolis;
using namespace aeolis::server;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double publisher_goal = 0.5, follower_goal = 50.0, lag_goal_ms = 100.0;
constexpr auto patience = 300s;
constexpr int packets_per_s = 2000, commits_per_s = 100, lag_seconds = 10;

double since_s(Clock::time_point begin) {
    return std::chrono::duration<double>{Clock::now() - begin}.count();
}

template <typename Condition>
void wait_for(Condition condition, const char* what) {
    const auto until = Clock::now() + patience;
    while (!condition()) {
        bench::must(Clock::now() < until, what);
        std::this_thread::sleep_for(1ms);
    }
}

cluster::EngineAddress at(const std::string& url) {
    cluster::EngineAddress address;
    address.url = url;
    return address;
}

std::unique_ptr<cluster::Publisher> published(const std::filesystem::path& file, const std::string& engine,
                                              std::uint16_t dictionary) {
    cluster::Publisher::Settings settings;
    settings.engine = at(engine);
    settings.archive = file;
    settings.dictionary = dictionary;
    return std::make_unique<cluster::Publisher>(std::move(settings));
}

std::unique_ptr<cluster::Follower> following(const std::filesystem::path& file, const std::string& engine,
                                             std::uint16_t dictionary, cluster::Follower::Parts parts) {
    auto shared = archive::SharedArchive::open(file);
    bench::must(shared.ok(), "the follower's archive");
    wait_for([&] { return cluster::begin_following(*shared, at(engine), "", dictionary).ok(); }, "following");
    cluster::Follower::Settings settings;
    settings.engine = at(engine);
    settings.archive = file;
    settings.dictionary = dictionary;
    auto started = cluster::Follower::start(std::move(settings), std::move(parts));
    bench::must(started.ok(), "the follower");
    return std::move(*started);
}

cluster::Follower::Parts no_parts() {
    return {[](archive::RunId, archive::Sequence, archive::Sequence) {}, [](v1::RunState) {}, [](v1::Clocks) {}};
}

/// How fast the steps of an archive travel. @return whether the goals are met
bool whole_landing(const std::filesystem::path& file, double landing_s) {
    test::TemporaryFolder folder;
    const tests::NatsServer server;
    auto writer = archive::Archive::open(file);
    bench::must(writer.ok(), "the archive");
    const auto dictionary = archive::RunRowsReader::open(file)->runs()->at(0).dictionary;
    const auto items = archive::RunRowsReader::open(file)->runs()->at(0).last_seq;

    auto begin = Clock::now();
    auto publisher = published(file, server.url(), dictionary);
    wait_for([&] { return publisher->status().items >= items && publisher->status().waiting_items == 0; },
             "publishing");
    const double publisher_s = since_s(begin);
    const auto octets = static_cast<double>(publisher->status().octets);

    const auto copy = folder / "copy.db";
    auto copied = archive::Archive::open(copy);
    bench::must(copied.ok(), "the follower's archive");
    begin = Clock::now();
    auto follower = following(copy, server.url(), dictionary, no_parts());
    wait_for([&] { return follower->status().items >= items; }, "catching up");
    const double follower_s = since_s(begin);
    follower.reset();
    publisher.reset();

    // The same messages, to a stream of their own.
    auto engine = cluster::Engine::connect(at(server.url()), "bare");
    bench::must(engine.ok(), "the engine");
    const auto identity = *archive::SharedArchive::open(file)->identity();
    auto reader = engine->read(cluster::run_stream, "bench", cluster::subject_of_runs(identity), 1);
    bench::must(reader.ok(), "reading the stream");
    std::vector<std::string> messages;
    for (;;) {
        auto given = reader->next(64, 200ms);
        bench::must(given.ok(), "reading the stream");
        if (given->empty()) break;
        for (const auto& one : *given) messages.emplace_back(one.octets());
    }
    bench::must(engine->make_stream("BARE", "bare.>", cluster::Retention::all).ok(), "a stream");
    begin = Clock::now();
    bench::must(engine->publish("bare.1", messages).ok(), "bare publishing");
    const double bare_s = since_s(begin);

    const double ratio = bare_s / publisher_s, times = landing_s / follower_s;
    std::printf("%llu items, %zu messages, %.1f MB packed\n", static_cast<unsigned long long>(items), messages.size(),
                octets / 1e6);
    std::printf("bare publisher %.2f s; publisher %.2f s, %.0f items/s: rate %.2f of the bare one's, goal %.2f, ratio "
                "%.2f\n",
                bare_s, publisher_s, static_cast<double>(items) / publisher_s, ratio, publisher_goal,
                ratio / publisher_goal);
    std::printf("follower catches up in %.2f s: %.0f x real time, goal %.0f, ratio %.2f\n", follower_s, times,
                follower_goal, times / follower_goal);
    return ratio >= publisher_goal && times >= follower_goal;
}

/// How late a follower has what is committed. @return whether the goal is met
bool lag() {
    test::TemporaryFolder folder;
    const tests::NatsServer server;
    const auto dictionary = test::small_dictionary();
    auto origin = archive::Archive::open(folder / "origin.db"), copy = archive::Archive::open(folder / "copy.db");
    bench::must(origin.ok() && copy.ok(), "the archives");
    const auto publisher = published(folder / "origin.db", server.url(), dictionary.id);

    std::mutex mutex;
    std::vector<std::pair<archive::Sequence, Clock::time_point>> commits;  // last item of each, and when
    std::size_t taken = 0;
    std::vector<double> lags_ms;
    auto parts = no_parts();
    parts.taken = [&](archive::RunId, archive::Sequence, archive::Sequence last) {
        const std::scoped_lock lock{mutex};
        for (; taken < commits.size() && commits[taken].first <= last; ++taken)
            lags_ms.push_back(since_s(commits[taken].second) * 1e3);
    };
    pipeline::Pipeline pipeline{*origin, dictionary};
    bench::must(pipeline.begin({}).ok(), "a run");
    const auto follower = following(folder / "copy.db", server.url(), dictionary.id, parts);
    auto next = Clock::now();
    for (int commit = 0; commit < lag_seconds * commits_per_s; ++commit) {
        for (int packet = 0; packet < packets_per_s / commits_per_s; ++packet)
            bench::must(pipeline
                            .accept(test::navigation(
                                static_cast<std::uint16_t>(commit * (packets_per_s / commits_per_s) + packet)))
                            .ok(),
                        "a packet");
        const auto done = pipeline.commit();
        bench::must(done.ok(), "a commit");
        {
            const std::scoped_lock lock{mutex};
            commits.emplace_back(pipeline.last_durable(), Clock::now());
        }
        next += std::chrono::milliseconds{1000 / commits_per_s};
        std::this_thread::sleep_until(next);
    }
    wait_for(
        [&] {
            const std::scoped_lock lock{mutex};
            return taken == commits.size();
        },
        "the follower's last item");
    std::sort(lags_ms.begin(), lags_ms.end());
    const double median_ms = lags_ms[lags_ms.size() / 2], p99_ms = lags_ms[lags_ms.size() * 99 / 100];
    std::printf("lag at %d packets/s: median %.1f ms, 99th percentile %.1f ms, goal %.0f ms, ratio %.2f\n",
                packets_per_s, median_ms, p99_ms, lag_goal_ms, p99_ms / lag_goal_ms);
    return p99_ms <= lag_goal_ms;
}

}  // namespace

int main() {
    if (!tests::NatsServer::present()) return 0;
    test::TemporaryFolder folder;
    const auto file = folder / "origin.db";
    const auto program = std::string{AEOLIS_SOURCE_DIR "/build/release/aeolis"};
    bench::must(
        std::system(("'" + program + "' rehearse --scenario nominal_auto --archive '" + file.string() + "' >/dev/null")
                        .c_str()) == 0,
        "the landing");
    constexpr double nominal_landing_s = 1724.0;  // of nominal_auto, from its first packet to its last
    const bool fast = whole_landing(file, nominal_landing_s), soon = lag();
    return fast && soon ? 0 : 1;
}
