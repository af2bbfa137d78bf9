#include "server/api/query_threads.hpp"

#include <spdlog/spdlog.h>

namespace aeolis::server {

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

QueryThreads::QueryThreads(std::vector<archive::Reader> readers, const Open& open, std::chrono::milliseconds question_max)
    : readers_(std::move(readers)) {
    for (auto& reader : readers_)
        threads_.emplace_back([this, &reader, open, question_max] {
            while (const auto asked = jobs_.pop()) {
                if (reader.outdated())
                    if (auto fresh = open()) reader = std::move(*fresh);
                answer(*asked, reader, question_max);
            }
        });
}

void QueryThreads::answer(const Asked& asked, archive::Reader& reader, std::chrono::milliseconds question_max) {
    const auto deadline = std::chrono::steady_clock::now() + question_max;
    reader.stop_when([deadline, gone = asked.gone] { return (gone && gone()) || std::chrono::steady_clock::now() > deadline; });
    try {
        asked.job(reader);
    } catch (const std::exception& bug) { // costs that question only; who asked has had its answer, or sees the connection end
        spdlog::error("a question could not be answered: {}", bug.what());
    }
    reader.stop_when({});
}

QueryThreads::~QueryThreads() {
    jobs_.close();
    for (auto& thread : threads_)
        thread.join();
}

bool QueryThreads::ask(Job job, std::function<bool()> gone) {
    if (!jobs_.try_push({std::move(job), std::move(gone)})) return false;
    ++asked_;
    return true;
}

} // namespace aeolis::server
