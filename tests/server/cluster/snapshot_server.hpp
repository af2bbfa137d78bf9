// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "server/archive/run_rows.hpp"
#include "server/base/json.hpp"
#include "server/cluster/run_snapshot.hpp"
#include "server/cluster/snapshot_fetcher.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace aeolis::tests {

/// What a server answers to a follower that fetches runs, of an archive's file and without HTTP. It can be cut.
class SnapshotServer {
  public:
    explicit SnapshotServer(std::filesystem::path archive) : archive_(std::move(archive)) {}

    std::atomic<std::size_t> octets_max{SIZE_MAX};           ///< of a run's answer, which is cut off there
    std::atomic<std::size_t> part_octets{10'000};            ///< of each part of an answer
    std::atomic<unsigned> refuses{0};                        ///< with this status; 0: it does not
    std::atomic<bool> waits{false};                          ///< before it answers for a run
    std::atomic<std::size_t> answers{0}, octets{0}, cut{0};  ///< for runs, since the start

    server::cluster::SnapshotSource source() {
        return {"http://origin",
                [this](const std::string& path, const auto& take, const auto& stop) { return get(path, take, stop); }};
    }
    std::vector<std::string> paths() {
        const std::scoped_lock lock{mutex_};
        return paths_;
    }

  private:
    using Answer = server::cluster::SnapshotSource::Answer;

    Result<Answer> get(const std::string& path, const server::cluster::SnapshotSource::Take& take,
                       const server::cluster::SnapshotSource::Stop& stop) {
        {
            const std::scoped_lock lock{mutex_};
            paths_.push_back(path);
        }
        if (refuses != 0) return problem(refuses, "log in first");
        if (path.starts_with("/api/v1/runs?")) return list(take);
        return rows(path, take, stop);
    }

    static Answer problem(unsigned status, const std::string& words) {
        v1::ErrorReply reply;
        reply.set_detail(words);
        return {.status = status, .body = server::to_json(reply)};
    }

    Result<Answer> list(const server::cluster::SnapshotSource::Take& take) {
        auto reader = archive::RunRowsReader::open(archive_);
        if (!reader) return reader.error();
        const auto runs = reader->runs();
        if (!runs) return runs.error();
        v1::RunList list;
        for (const auto& run : *runs) {
            auto& listed = *list.add_runs();
            listed.set_run(run.run.value);
            listed.set_last_seq(run.last_seq);
        }
        take(server::to_json(list));
        return Answer{.status = 200};
    }

    Result<Answer> rows(const std::string& path, const server::cluster::SnapshotSource::Take& take,
                        const server::cluster::SnapshotSource::Stop& stop) {
        while (waits && !stop()) std::this_thread::sleep_for(std::chrono::milliseconds{2});
        if (stop()) return Answer{.lost = "broken off"};
        const std::string prefix = "/api/v1/runs/", query = "/rows?held=";
        const auto end = path.find(query);
        const archive::RunId run{static_cast<std::uint32_t>(std::stoul(path.substr(prefix.size())))};
        v1::RunPosition held;
        if (const auto parsed = server::from_json(decoded(path.substr(end + query.size())), held); !parsed)
            return problem(400, parsed.error().message);
        auto snapshot = server::cluster::RunSnapshot::begin(archive_, run, held);
        if (!snapshot)
            return problem(snapshot.error().message.ends_with("there is none") ? 404 : 409, snapshot.error().message);
        ++answers;
        std::size_t given = 0;
        for (;;) {
            auto message = snapshot->next();
            if (!message) return message.error();
            if (!*message) return Answer{.status = 200};
            for (std::size_t at = 0; at < (*message)->size(); at += part_octets) {
                const auto part = (*message)->substr(at, std::min(part_octets.load(), octets_max - given));
                if (part.empty() || stop()) {
                    ++cut;
                    return Answer{.status = 200, .lost = "its answer was cut off"};
                }
                given += part.size();
                octets += part.size();
                if (!take(part)) return Answer{.status = 200, .lost = "no more was wanted"};
            }
        }
    }

    static std::string decoded(const std::string& text) {
        std::string octets;
        for (std::size_t at = 0; at < text.size(); ++at) {
            if (text[at] != '%') {
                octets += text[at];
                continue;
            }
            octets += static_cast<char>(std::stoi(text.substr(at + 1, 2), nullptr, 16));
            at += 2;
        }
        return octets;
    }

    const std::filesystem::path archive_;
    std::mutex mutex_;
    std::vector<std::string> paths_;
};

}  // namespace aeolis::tests
