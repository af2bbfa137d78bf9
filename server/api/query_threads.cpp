#include "server/api/query_threads.hpp"

namespace aeolis::server {

Result<std::unique_ptr<QueryThreads>> QueryThreads::open(const std::filesystem::path& archive,
                                                         const dictionary::Dictionary& dictionary,
                                                         const telemetry::OtherMission* other) {
    std::vector<archive::Reader> readers;
    for (std::size_t i = 0; i < threads; ++i) {
        auto reader = archive::Reader::open(archive, dictionary, other);
        if (!reader) return reader.error();
        readers.push_back(std::move(reader).value());
    }
    return std::unique_ptr<QueryThreads>{new QueryThreads{std::move(readers)}};
}

QueryThreads::QueryThreads(std::vector<archive::Reader> readers) : readers_(std::move(readers)) {
    for (auto& reader : readers_)
        threads_.emplace_back([this, &reader] {
            while (auto job = jobs_.pop())
                (*job)(reader);
        });
}

QueryThreads::~QueryThreads() {
    jobs_.close();
    for (auto& thread : threads_)
        thread.join();
}

bool QueryThreads::ask(Job job) {
    if (!jobs_.try_push(std::move(job))) return false;
    ++asked_;
    return true;
}

} // namespace aeolis::server
