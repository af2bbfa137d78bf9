// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/shared_archive.hpp"
#include "server/cluster/follower.hpp"
#include "server/cluster/publisher.hpp"
#include "tests/server/cluster/nats_server.hpp"
#include "tests/server/run_copies.hpp"
#include "tests/support/catch.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

// An archive that is published and one that follows it, in this process.
namespace aeolis::tests {

using namespace std::chrono_literals;
using namespace aeolis::server;
using archive::Archive;
using archive::RunId;
using archive::SharedArchive;
using cluster::Engine;

inline const dictionary::Dictionary followed_dictionary = test::small_dictionary();

inline cluster::EngineAddress at(const std::string& url) {
    cluster::EngineAddress address;
    address.url = url;
    return address;
}

inline Engine connected(const NatsServer& server, const std::string& name = "test") {
    auto engine = Engine::connect(at(server.url()), name);
    REQUIRE(engine);
    return std::move(*engine);
}

/// Waits for something that must come; a machine that builds meanwhile is slow.
template <typename Condition>
bool comes(Condition condition) {
    const auto until = std::chrono::steady_clock::now() + 60s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > until) return false;
        std::this_thread::sleep_for(5ms);
    }
    return true;
}

/// An archive, its writer and its publisher.
class Origin {
  public:
    Origin(std::filesystem::path file, const std::string& engine) : Origin(std::move(file), at(engine)) {}
    Origin(std::filesystem::path file, const cluster::EngineAddress& engine)
        : file_(std::move(file)), archive(std::move(Archive::open(file_)).value()) {
        publish(engine);
    }
    void publish(const std::string& engine) { publish(at(engine)); }
    void publish(const cluster::EngineAddress& engine) {
        cluster::Publisher::Settings settings;
        settings.engine = engine;
        settings.archive = file_;
        settings.dictionary = followed_dictionary.id;
        settings.tell_every = 100ms;
        settings.again_after = 20ms;
        publisher = std::make_unique<cluster::Publisher>(std::move(settings));
    }
    const std::filesystem::path& file() const { return file_; }
    std::string identity() const { return *SharedArchive::open(file_)->identity(); }

  private:
    std::filesystem::path file_;

  public:
    Archive archive;
    std::unique_ptr<cluster::Publisher> publisher;
};

/// An archive that follows, and what it gave on.
class Copy {
  public:
    Copy(std::filesystem::path file, const std::string& engine, const std::string& origin = {},
         std::uint16_t of_dictionary = followed_dictionary.id, cluster::ChosenRuns runs = {},
         cluster::SnapshotSource snapshots = {})
        : Copy(std::move(file), at(engine), origin, of_dictionary, std::move(runs), std::move(snapshots)) {}
    Copy(std::filesystem::path file, const cluster::EngineAddress& engine, const std::string& origin = {},
         std::uint16_t of_dictionary = followed_dictionary.id, cluster::ChosenRuns runs = {},
         cluster::SnapshotSource snapshots = {})
        : file_(std::move(file)), archive(std::move(Archive::open(file_)).value()) {
        auto shared = SharedArchive::open(file_);
        REQUIRE(shared);
        Result<void> begun;
        const bool followed = comes([&] {
            begun = cluster::begin_following(*shared, engine, origin, of_dictionary);
            return begun.ok();  // until the origin has said that it is there
        });
        INFO((begun ? "" : begun.error().message));
        REQUIRE(followed);
        cluster::Follower::Settings settings;
        settings.engine = engine;
        settings.archive = file_;
        settings.dictionary = of_dictionary;
        settings.runs = std::move(runs);
        settings.snapshots = std::move(snapshots);
        settings.wait = 20ms;
        settings.look_every = 50ms;
        settings.lost_after = 2s;
        settings.again_after = 20ms;
        settings.fetch_again_after = 100ms;
        cluster::Follower::Parts parts;
        parts.taken = [this](RunId run, archive::Sequence first, archive::Sequence last) {
            const std::scoped_lock lock{mutex_};
            auto& through = through_[run.value];
            if (through != 0 && first != through + 1) gaps_ = true;
            through = last;
        };
        parts.run_state = [this](v1::RunState state) {
            const std::scoped_lock lock{mutex_};
            state_ = std::move(state);
        };
        parts.clocks = [](const v1::Clocks&) {};
        auto started = cluster::Follower::start(std::move(settings), std::move(parts));
        REQUIRE(started);
        follower = std::move(*started);
    }
    const std::filesystem::path& file() const { return file_; }
    bool gaps() {
        const std::scoped_lock lock{mutex_};
        return gaps_;
    }
    v1::RunState state() {
        const std::scoped_lock lock{mutex_};
        return state_;
    }

  private:
    std::filesystem::path file_;
    std::mutex mutex_;
    std::map<std::uint32_t, archive::Sequence> through_;
    bool gaps_ = false;
    v1::RunState state_;

  public:
    Archive archive;
    std::unique_ptr<cluster::Follower> follower;  // ends first
};

inline bool same(const std::filesystem::path& origin, const std::filesystem::path& copy) {
    return test::rows_of_runs(copy) == test::rows_of_runs(origin);
}

/// A run in packets, with a pause after each commit.
inline void record_slowly(Archive& archive, std::uint16_t packets, std::chrono::milliseconds pause) {
    pipeline::Pipeline pipeline{archive, followed_dictionary};
    REQUIRE(pipeline.begin({}));
    for (std::uint16_t count = 0; count < packets; ++count) {
        REQUIRE(pipeline.accept(test::navigation(count)));
        if (count % 20 != 19) continue;
        REQUIRE(comes([&] { return pipeline.commit().ok(); }));  // tried again, as the pipeline's thread does
        std::this_thread::sleep_for(pause);
    }
    REQUIRE(comes([&] { return pipeline.finish({archive::Outcome::touchdown, "", "", ""}).ok(); }));
}

}  // namespace aeolis::tests
