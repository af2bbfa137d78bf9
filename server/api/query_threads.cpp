// SPDX-License-Identifier: Apache-2.0
#include "server/api/query_threads.hpp"

#include <algorithm>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::array what_is_short{JobPriority::at_once, JobPriority::soon};
constexpr std::array questions_first{JobPriority::in_turn, JobPriority::soon};

std::function<bool()> disconnected_or_late(std::function<bool()> disconnected, std::chrono::milliseconds question_max) {
    const auto deadline = std::chrono::steady_clock::now() + question_max;
    return [deadline, disconnected = std::move(disconnected)] {
        return (disconnected && disconnected()) || std::chrono::steady_clock::now() > deadline;
    };
}

}  // namespace

Result<std::unique_ptr<QueryThreads>> QueryThreads::open(const std::filesystem::path& archive,
                                                         const dictionary::Dictionary& dictionary,
                                                         const telemetry::OtherMission* other,
                                                         std::chrono::milliseconds question_max) {
    const auto open = [archive, &dictionary, other] { return archive::Reader::open(archive, dictionary, other); };
    std::vector<archive::Reader> readers;
    for (std::size_t i = 0; i < threads; ++i) {
        auto reader = open();
        if (!reader) return reader.error();
        readers.push_back(std::move(reader).value());
    }
    return std::unique_ptr<QueryThreads>{new QueryThreads{std::move(readers), open, question_max}};
}

QueryThreads::QueryThreads(std::vector<archive::Reader> readers, const Open& open,
                           std::chrono::milliseconds question_max)
    : waiting_{TurnQueue<WaitingJob>{waiting_max[0], of_client_waiting_max},
               TurnQueue<WaitingJob>{waiting_max[1], of_client_waiting_max},
               TurnQueue<WaitingJob>{waiting_max[2], of_client_waiting_max}},
      readers_(std::move(readers)) {
    for (std::size_t i = 0; i < threads; ++i) {
        const auto kinds = i < question_threads ? std::span<const JobPriority>{questions_first}
                                                : std::span<const JobPriority>{what_is_short};
        threads_.emplace_back(
            [this, &reader = readers_[i], kinds, open, question_max] { serve(reader, kinds, open, question_max); });
    }
}

void QueryThreads::serve(archive::Reader& reader, std::span<const JobPriority> kinds, const Open& open,
                         std::chrono::milliseconds question_max) {
    while (const auto asked = next(kinds)) {
        if (reader.outdated())
            if (auto fresh = open()) reader = std::move(*fresh);
        answer(*asked, reader, question_max);
        done(*asked);
    }
}

std::function<bool()> QueryThreads::stop_of_question(std::function<bool()> disconnected,
                                                     std::chrono::milliseconds question_max) const {
    // After the end nobody receives the answer.
    return [this, stop = disconnected_or_late(std::move(disconnected), question_max)] { return over_ || stop(); };
}

void QueryThreads::take_turn(std::unique_lock<std::mutex>& lock) {
    const auto place = next_place_++;
    line_.push_back(place);
    changed_.wait(lock, [&] { return over_ || (running_ < running_max && line_.front() == place); });
    std::erase(line_, place);
    ++running_;
    changed_.notify_all();  // the next in line may have a turn, too
}

void QueryThreads::give_turn() {
    {
        const std::scoped_lock lock{mutex_};
        --running_;
    }
    changed_.notify_all();
}

void QueryThreads::give_way(Clock::time_point& slice_began) {
    if (Clock::now() - slice_began < slice) return;
    std::unique_lock lock{mutex_};
    if (!line_.empty() && !over_) {
        --running_;
        changed_.notify_all();
        take_turn(lock);
    }
    slice_began = Clock::now();
}

void QueryThreads::answer(const WaitingJob& asked, archive::Reader& reader, std::chrono::milliseconds question_max) {
    if (asked.priority == JobPriority::in_turn) {
        const auto stop = stop_of_question(asked.asker.disconnected, question_max);
        {
            std::unique_lock lock{mutex_};
            take_turn(lock);
        }
        reader.stop_when([this, stop, slice_began = Clock::now()]() mutable {
            give_way(slice_began);
            return stop();
        });
    } else {
        reader.stop_when(disconnected_or_late(asked.asker.disconnected, question_max));
    }
    try {
        asked.job(reader);
    } catch (const std::exception& bug) {  // fails only this query
        spdlog::error("a question could not be answered: {}", bug.what());
    }
    reader.stop_when({});
    if (asked.priority == JobPriority::in_turn) give_turn();
}

void QueryThreads::end() {
    {
        const std::scoped_lock lock{mutex_};
        over_ = true;
    }
    changed_.notify_all();
    for (auto& thread : threads_) thread.join();
    threads_.clear();
}

std::size_t QueryThreads::of_client_now() const {
    const auto& waiting = waiting_[static_cast<std::size_t>(JobPriority::in_turn)].clients();
    const auto further =
        std::ranges::count_if(waiting, [this](const std::string& client) { return !questions_of_.contains(client); });
    return questions_of_.size() + static_cast<std::size_t>(further) < crowd_min ? of_client_max : 1;
}

bool QueryThreads::may_begin(JobPriority kind, const std::string& client, std::size_t of_client) const {
    if (kind != JobPriority::in_turn || client.empty() || over_) return true;
    const auto under_way = questions_of_.find(client);
    return under_way == questions_of_.end() || under_way->second < of_client;
}

std::optional<QueryThreads::WaitingJob> QueryThreads::next(std::span<const JobPriority> kinds) {
    const auto may = [this](JobPriority kind) {
        return [this, kind, of_client = of_client_now()](const std::string& client) {
            return may_begin(kind, client, of_client);
        };
    };
    const auto first = [&] {
        return std::ranges::find_if(
            kinds, [&](JobPriority kind) { return waiting_[static_cast<std::size_t>(kind)].has(may(kind)); });
    };
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [&] { return over_ || first() != kinds.end(); });
    const auto kind = first();
    if (kind == kinds.end()) return std::nullopt;
    auto asked = waiting_[static_cast<std::size_t>(*kind)].pop(may(*kind));
    if (*kind == JobPriority::in_turn) {
        ++questions_of_[asked->asker.client];
        note_wait(*asked);
    }
    return asked;
}

void QueryThreads::note_wait(const WaitingJob& taken) {
    const bool room = waits_.size() < waits_clients_max || waits_.contains(taken.asker.client);
    auto& waits = waits_[room ? taken.asker.client : other_clients];
    const double waited_s = std::chrono::duration<double>{Clock::now() - taken.asked}.count();
    ++waits.queries;
    waits.all_s += waited_s;
    waits.longest_s = std::max(waits.longest_s, waited_s);
}

std::map<std::string, QueryThreads::Waits> QueryThreads::waits() const {
    const std::scoped_lock lock{mutex_};
    return waits_;
}

void QueryThreads::done(const WaitingJob& asked) {
    if (asked.priority != JobPriority::in_turn) return;
    {
        const std::scoped_lock lock{mutex_};
        const auto found = questions_of_.find(asked.asker.client);
        if (--found->second == 0) questions_of_.erase(found);
    }
    changed_.notify_all();
}

bool QueryThreads::ask(Job job, Asker asker, JobPriority priority) {
    {
        const std::scoped_lock lock{mutex_};
        const std::string client = asker.client;
        auto& waiting = waiting_[static_cast<std::size_t>(priority)];
        if (over_ || !waiting.push(client, {std::move(job), std::move(asker), priority})) return false;
    }
    changed_.notify_all();  // all threads: one of them takes this kind
    ++asked_;
    return true;
}

std::size_t QueryThreads::waiting() const {
    const std::scoped_lock lock{mutex_};
    std::size_t all = 0;
    for (const auto& each : waiting_) all += each.size();
    return all;
}

}  // namespace aeolis::server
