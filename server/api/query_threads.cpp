// SPDX-License-Identifier: Apache-2.0
#include "server/api/query_threads.hpp"

#include <algorithm>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::array what_is_short{JobPriority::at_once, JobPriority::soon};
constexpr std::array questions_first{JobPriority::in_turn, JobPriority::soon};

std::function<bool()> gone_or_late(std::function<bool()> gone, std::chrono::milliseconds question_max) {
    const auto deadline = std::chrono::steady_clock::now() + question_max;
    return
        [deadline, gone = std::move(gone)] { return (gone && gone()) || std::chrono::steady_clock::now() > deadline; };
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
    : readers_(std::move(readers)) {
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
    }
}

std::function<bool()> QueryThreads::stop_of_question(std::function<bool()> gone,
                                                     std::chrono::milliseconds question_max) const {
    // After the end nobody receives the answer.
    return [this, stop = gone_or_late(std::move(gone), question_max)] { return over_ || stop(); };
}

void QueryThreads::answer(const WaitingJob& asked, archive::Reader& reader, std::chrono::milliseconds question_max) {
    reader.stop_when(asked.priority == JobPriority::in_turn ? stop_of_question(asked.gone, question_max)
                                                            : gone_or_late(asked.gone, question_max));
    try {
        asked.job(reader);
    } catch (const std::exception& bug) {  // fails only this query
        spdlog::error("a question could not be answered: {}", bug.what());
    }
    reader.stop_when({});
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

std::optional<QueryThreads::WaitingJob> QueryThreads::next(std::span<const JobPriority> kinds) {
    const auto first = [&] {
        return std::ranges::find_if(
            kinds, [&](JobPriority kind) { return !waiting_[static_cast<std::size_t>(kind)].empty(); });
    };
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [&] { return over_ || first() != kinds.end(); });
    const auto kind = first();
    if (kind == kinds.end()) return std::nullopt;
    auto& waiting = waiting_[static_cast<std::size_t>(*kind)];
    std::optional<WaitingJob> asked{std::move(waiting.front())};
    waiting.pop_front();
    return asked;
}

bool QueryThreads::ask(Job job, std::function<bool()> gone, JobPriority priority) {
    const auto kind = static_cast<std::size_t>(priority);
    {
        const std::scoped_lock lock{mutex_};
        if (over_ || waiting_[kind].size() >= waiting_max[kind]) return false;
        waiting_[kind].push_back({std::move(job), std::move(gone), priority});
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
