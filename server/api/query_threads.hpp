#pragma once

#include "common/result.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/bounded_queue.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace aeolis::server {

/// Two threads that read: each has its own read-only connection to the archive, and takes a new one when the file was put
/// back under its name. So a long query never holds up the network, the writer, or the other query.
class QueryThreads {
  public:
    static constexpr std::size_t threads = 2;
    static constexpr std::size_t waiting_max = 256; ///< ours: more is refused, "busy"

    /// A question that takes longer, or whose asker has gone, is stopped: its reader then says stopped().
    static constexpr std::chrono::seconds question_seconds_max{20}; ///< ours: proof() of a whole landing takes one

    using Job = std::function<void(archive::Reader&)>;

    /// The archive has been made. The dictionary must outlive this.
    static Result<std::unique_ptr<QueryThreads>> open(const std::filesystem::path& archive,
                                                      const dictionary::Dictionary& dictionary,
                                                      const telemetry::OtherMission* other = nullptr,
                                                      std::chrono::milliseconds question_max = question_seconds_max);
    ~QueryThreads(); ///< does what waits, then ends

    /// False, and nothing done, when too much waits.
    bool ask(Job job, std::function<bool()> gone = {});
    std::uint64_t asked() const { return asked_; }
    std::size_t waiting() const { return jobs_.size(); }

  private:
    using Open = std::function<Result<archive::Reader>()>;
    QueryThreads(std::vector<archive::Reader> readers, const Open& open, std::chrono::milliseconds question_max);
    struct Asked {
        Job job;
        std::function<bool()> gone; ///< null: never told
    };
    static void answer(const Asked& asked, archive::Reader& reader, std::chrono::milliseconds question_max);
    BoundedQueue<Asked> jobs_{waiting_max};
    std::vector<archive::Reader> readers_;
    std::atomic<std::uint64_t> asked_{0};
    std::vector<std::thread> threads_;
};

} // namespace aeolis::server
