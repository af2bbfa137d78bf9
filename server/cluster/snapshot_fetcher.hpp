// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/base/bounded_queue.hpp"
#include "server/cluster/run_snapshot.hpp"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

namespace aeolis::server::cluster {

/// Another server's API, as far as its runs are fetched from there.
struct SnapshotSource {
    /// What it answered. With status 200 its body was given on as it came.
    struct Answer {
        unsigned status = 0;
        std::string body{};  ///< of another status
        std::string lost{};  ///< why the answer is incomplete; empty: it is whole
    };
    using Take = std::function<bool(std::string_view)>;  ///< a part of the body; false: no more is wanted
    using Stop = std::function<bool()>;                  ///< asked several times a second
    std::string shown{};                                 ///< its address, for people
    /// Gets a path, blocking until its end. Null: there is no such server.
    std::function<Result<Answer>(const std::string& path, const Take& take, const Stop& stop)> get{};
};

/// Fetches runs from another server, one request at a time.
///
/// In       list() and fetch(), each after the end of the one before
/// Out      news, in their order: the last of each request is Listed or Ended
/// Memory   a message of a run, and those that wait to be taken: `waiting_max`
/// Faults   what the server refuses or breaks off ends the request, with a sentence
/// Threads  one of its own, on which the source is asked. The rest by one owner
class SnapshotFetcher {
  public:
    static constexpr std::size_t waiting_max = 4;
    static constexpr std::size_t runs_max = 100'000;  ///< of a list; chosen: beyond what an archive of 4 TB holds

    struct ListedRun {
        archive::RunId run;
        archive::Sequence last = 0;
    };
    using Listed = std::vector<ListedRun>;
    struct Ended {
        std::string fault;  ///< empty: the run was given to its end
        bool gone = false;  ///< there is no such run
    };
    using News = std::variant<Listed, v1::RunRows, Ended>;

    explicit SnapshotFetcher(SnapshotSource source);
    SnapshotFetcher(const SnapshotFetcher&) = delete;
    SnapshotFetcher& operator=(const SnapshotFetcher&) = delete;
    ~SnapshotFetcher();

    const std::string& source() const { return source_.shown; }
    /// Asks which runs there are.
    void list();
    /// Asks for what comes of a run behind `held`.
    void fetch(archive::RunId run, const v1::RunPosition& held);
    /// Nothing more is wanted of what is under way: its end comes soon.
    void break_off() { broken_off_ = true; }
    /// What came next; none: nothing yet.
    std::optional<News> next();

  private:
    struct Asked {
        archive::RunId run;  ///< 0: the list
        v1::RunPosition held;
    };
    void ask(Asked asked);
    void run();
    News answer_of_list();
    Ended answer_of_run(const Asked& asked);

    const SnapshotSource source_;
    BoundedQueue<News> news_{waiting_max};
    std::atomic<bool> stop_{false}, broken_off_{false};
    std::mutex mutex_;  // of asked_
    std::condition_variable wake_;
    std::optional<Asked> asked_;
    std::thread thread_;
};

}  // namespace aeolis::server::cluster
