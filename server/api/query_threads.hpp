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

/// How long a job may take says what it waits behind.
enum class JobPriority : std::uint8_t {
    at_once,  ///< milliseconds, and somebody cannot go on without it: an acknowledgement, a file of the console
    soon,     ///< a second at most, or many at once: a page of what a client of the stream missed, a log-in, a list, a
              ///< check of the timeline
    in_turn,  ///< a question, of up to question_seconds_max
};

/// Threads that read: each has its own read-only connection to the archive, and takes a new one when the file was put
/// back under its name. So a long query never holds up the network, the writer, or the other query.
///
/// One thread never takes questions: however many there are and however long, what is short goes on. The others take
/// questions before what may come soon, so that a thousand clients which catch up keep nobody from an answer.
class QueryThreads {
  public:
    static constexpr std::size_t question_threads = 2;
    static constexpr std::size_t threads = question_threads + 1;
    /// Chosen, by JobPriority: more is refused, "busy". Each connection of the stream asks for one page at a time, and
    /// there are at most 1 000 of them: that no page is refused, there is room for two each.
    static constexpr std::array<std::size_t, 3> waiting_max{256, 2'000, 256};
    static constexpr const char* busy = "too many questions wait: try again";

    /// A question that takes longer, or whose asker has gone, is stopped: its reader then says stopped().
    static constexpr std::chrono::seconds question_seconds_max{20};  ///< ours: proof() of a whole landing takes one

    using Job = std::function<void(archive::Reader&)>;

    /// The archive has been made. The dictionary must outlive this.
    static Result<std::unique_ptr<QueryThreads>> open(const std::filesystem::path& archive,
                                                      const dictionary::Dictionary& dictionary,
                                                      const telemetry::OtherMission* other = nullptr,
                                                      std::chrono::milliseconds question_max = question_seconds_max);
    ~QueryThreads() { end(); }
    /// Does what waits that is short, stops every question, and takes nothing more. Once; of the thread that made this.
    void end();

    /// False, and nothing done, when too much waits.
    bool ask(Job job, std::function<bool()> gone = {}, JobPriority priority = JobPriority::in_turn);
    /// For a question that reads another file than the archive: whether it is to be stopped, as its reader would be. It
    /// begins now, on one of these threads.
    std::function<bool()> stop_of_question(std::function<bool()> gone,
                                           std::chrono::milliseconds question_max = question_seconds_max) const;
    std::uint64_t asked() const { return asked_; }
    std::size_t waiting() const;  ///< of all kinds

  private:
    using Open = std::function<Result<archive::Reader>()>;
    QueryThreads(std::vector<archive::Reader> readers, const Open& open, std::chrono::milliseconds question_max);
    struct WaitingJob {
        Job job;
        std::function<bool()> gone;  ///< null: never told
        JobPriority priority{};
    };
    /// The first of the first of `kinds` of which one waits; none when it is over and nothing of them waits.
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
