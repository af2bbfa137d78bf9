// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/api/turn_queue.hpp"
#include "server/archive/reader.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::server {

/// The priority of a job, by how long it may take.
enum class JobPriority : std::uint8_t {
    at_once,  ///< milliseconds, and somebody is blocked until then: an acknowledgement, a file of the console
    soon,     ///< a second at most, or many at once: a page of the stream's past, a log-in, a list, a timeline check
    in_turn,  ///< a query of up to question_seconds_max
};

/// The client for whom a job is done, by which jobs are served in turn.
struct Asker {
    std::string client{};                  ///< an account, a browser, or an address; empty: the server itself
    std::function<bool()> disconnected{};  ///< whether the client has disconnected; null: unknown
};

/// Threads that query the archive, each with its own read-only connection. A thread reconnects when the file was
/// replaced under its name. A long query never delays the network or the writer.
///
/// Shares   clients are served in turn. One client's queries take of_client_max threads at most, and a single one once
///          crowd_min clients ask; of the queries under way running_max run at a time, in turn for a slice each. So a
///          query waits for a few slices while a thread is free, and for the end of another query when as many other
///          clients ask as there are threads
/// Short    one thread takes no queries (in_turn), so that short jobs always proceed. The others take queries before
///          jobs of priority `soon`, so that a thousand clients catching up delay nobody's query
class QueryThreads {
  public:
    static constexpr std::size_t question_threads = 6;  ///< chosen: each holds a connection of some MB and a list
    static constexpr std::size_t threads = question_threads + 1;
    static constexpr std::size_t running_max = 2;         ///< chosen: of question threads at a time; others are paused
    static constexpr std::size_t of_client_max = 2;       ///< chosen: question threads for one client's queries
    static constexpr std::size_t crowd_min = 3;           ///< chosen: clients from which on each has only one
    static constexpr std::chrono::milliseconds slice{5};  ///< chosen: before a query gives way to one that waits
    /// Chosen, by JobPriority; beyond it a job is refused ("busy"). Each stream connection asks for one page at a time,
    /// and there are at most 1 000 of them: room for two pages each means that none is refused.
    static constexpr std::array<std::size_t, 3> waiting_max{256, 2'000, 256};
    /// Waiting jobs of one client, of each priority; chosen. Streams count as the server itself, with one page a
    /// connection.
    static constexpr std::size_t of_client_waiting_max = 64;
    static constexpr const char* busy = "too many questions wait: try again";

    /// A query that takes longer, pauses included, or whose client has disconnected, is stopped: its reader then
    /// reports stopped().
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
    bool ask(Job job, Asker asker = {}, JobPriority priority = JobPriority::in_turn);
    /// The stop condition for a query that reads a file other than the archive, the same as a reader's. Its time starts
    /// now. Call on one of these threads.
    std::function<bool()> stop_of_question(std::function<bool()> disconnected,
                                           std::chrono::milliseconds question_max = question_seconds_max) const;
    std::uint64_t asked() const { return asked_; }
    /// How long queries waited until a thread took them.
    struct Waits {
        std::uint64_t queries = 0;
        double all_s = 0.0, longest_s = 0.0;
    };
    static constexpr std::size_t waits_clients_max = 100;  ///< chosen; the rest is counted under other_clients
    static constexpr const char* other_clients = "others";
    std::map<std::string, Waits> waits() const;  ///< by client, since the start
    std::size_t waiting() const;                 ///< of all priorities

  private:
    using Open = std::function<Result<archive::Reader>()>;
    using Clock = std::chrono::steady_clock;
    QueryThreads(std::vector<archive::Reader> readers, const Open& open, std::chrono::milliseconds question_max);
    struct WaitingJob {
        Job job;
        Asker asker;
        JobPriority priority{};
        Clock::time_point asked = Clock::now();
    };
    /// Takes the next job of the first of `kinds` that has one; none once ended and none of these kinds waits.
    std::optional<WaitingJob> next(std::span<const JobPriority> kinds);
    /// How many queries of one client may be under way now. Call with mutex_ held.
    std::size_t of_client_now() const;
    /// Whether a client's job of this kind may begin now, by of_client_now(). Call with mutex_ held.
    bool may_begin(JobPriority kind, const std::string& client, std::size_t of_client) const;
    void note_wait(const WaitingJob& taken);  ///< call with mutex_ held
    void serve(archive::Reader& reader, std::span<const JobPriority> kinds, const Open& open,
               std::chrono::milliseconds question_max);
    void done(const WaitingJob& asked);
    void answer(const WaitingJob& asked, archive::Reader& reader, std::chrono::milliseconds question_max);
    // The turns of the question threads, each with its place in line.
    void take_turn(std::unique_lock<std::mutex>& lock);
    void give_turn();
    /// Pauses the query that runs on this thread when its slice is over and another waits.
    void give_way(Clock::time_point& slice_began);

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::array<TurnQueue<WaitingJob>, waiting_max.size()> waiting_;  ///< by JobPriority
    std::map<std::string, std::size_t> questions_of_;                ///< under way, by client
    std::map<std::string, Waits> waits_;                             ///< by client
    std::size_t running_ = 0;                                        ///< threads that have a turn
    std::uint64_t next_place_ = 0;
    std::deque<std::uint64_t> line_;  ///< places of threads that wait for a turn
    std::atomic<bool> over_{false};   ///< set under mutex_
    std::vector<archive::Reader> readers_;
    std::atomic<std::uint64_t> asked_{0};
    std::vector<std::thread> threads_;
};

}  // namespace aeolis::server
