// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/reader.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

namespace aeolis::server {

/// The priority of a job, by how long it may take.
enum class JobPriority : std::uint8_t {
    at_once,  ///< milliseconds, and somebody is blocked until then: an acknowledgement, a file of the console
    soon,     ///< a second at most, or many at once: a page of the stream's past, a log-in, a list, a timeline check
    in_turn,  ///< a query of up to question_seconds_max
};

/// Threads that query the archive, each with its own read-only connection. A thread reconnects when the file was
/// replaced under its name. A long query never delays the network, the writer, or the other query.
///
/// One thread takes no queries (in_turn), so that short jobs always proceed. The others take queries before jobs of
/// priority `soon`, so that a thousand clients catching up delay nobody's query.
class QueryThreads {
  public:
    static constexpr std::size_t question_threads = 2;
    static constexpr std::size_t threads = question_threads + 1;
    /// Chosen, by JobPriority; beyond it a job is refused ("busy"). Each stream connection asks for one page at a time,
    /// and there are at most 1 000 of them: room for two pages each means that none is refused.
    static constexpr std::array<std::size_t, 3> waiting_max{256, 2'000, 256};
    static constexpr const char* busy = "too many questions wait: try again";

    /// A query that takes longer, or whose client has disconnected, is stopped: its reader then reports stopped().
    static constexpr std::chrono::seconds question_seconds_max{20};  ///< chosen: proof() takes 1 s

    using Job = std::function<void(archive::Reader&)>;

    /// Starts the threads. The archive file must exist; the dictionary must outlive this.
    static Result<std::unique_ptr<QueryThreads>> open(const std::filesystem::path& archive,
                                                      const dictionary::Dictionary& dictionary,
                                                      const telemetry::OtherMission* other = nullptr,
                                                      std::chrono::milliseconds question_max = question_seconds_max);
    ~QueryThreads() { end(); }
    /// Finishes the short jobs that wait, stops every query, and takes nothing more. Call once, on the thread that made
    /// this.
    void end();

    /// Queues a job. False, and not queued, when too many wait.
    bool ask(Job job, std::function<bool()> gone = {}, JobPriority priority = JobPriority::in_turn);
    /// The stop condition for a query that reads a file other than the archive, the same as a reader's. Its time starts
    /// now. Call on one of these threads.
    std::function<bool()> stop_of_question(std::function<bool()> gone,
                                           std::chrono::milliseconds question_max = question_seconds_max) const;
    std::uint64_t asked() const { return asked_; }
    std::size_t waiting() const;  ///< of all priorities

  private:
    using Open = std::function<Result<archive::Reader>()>;
    QueryThreads(std::vector<archive::Reader> readers, const Open& open, std::chrono::milliseconds question_max);
    struct WaitingJob {
        Job job;
        std::function<bool()> gone;  ///< null: unknown
        JobPriority priority{};
    };
    /// Takes the oldest job of the first of `kinds` that has one; none once ended and none of these kinds waits.
    std::optional<WaitingJob> next(std::span<const JobPriority> kinds);
    void serve(archive::Reader& reader, std::span<const JobPriority> kinds, const Open& open,
               std::chrono::milliseconds question_max);
    void answer(const WaitingJob& asked, archive::Reader& reader, std::chrono::milliseconds question_max);

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::array<std::deque<WaitingJob>, waiting_max.size()> waiting_;  ///< by JobPriority, each first in, first out
    std::atomic<bool> over_{false};                                   ///< set under mutex_
    std::vector<archive::Reader> readers_;
    std::atomic<std::uint64_t> asked_{0};
    std::vector<std::thread> threads_;
};

}  // namespace aeolis::server
