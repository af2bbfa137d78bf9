// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign.hpp"

#include "common/check.hpp"
#include "server/base/bounded_queue.hpp"
#include "server/rehearsal/scripted_landing.hpp"

#include <chrono>
#include <thread>
#include <vector>

namespace aeolis::server::campaign {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto keep_at_most = std::chrono::milliseconds{500};  // longest time until durable
constexpr auto tell_every = std::chrono::milliseconds{100};
constexpr std::size_t waiting_per_job = 2;  // so that no thread waits for the one that stores

using Fly = std::function<std::optional<CaseResult>(std::uint64_t)>;

std::optional<CaseResult> flown(const Fly& fly, std::uint64_t number) {
    CaseResult lost;
    lost.number = number;
    lost.outcome = simulation::name_of(simulation::Outcome::lost);
    try {
        return fly(number);
    } catch (const CheckFailed& bug) {
        lost.reason = text_of_bug(bug);
    } catch (const std::exception& error) {
        lost.reason = error.what();
    }
    return lost;
}

/// Threads that fly the numbers in `wanted`. The owner closes `wanted` and reads `done` to its end.
class CaseThreads {
  public:
    CaseThreads(unsigned jobs, const Fly& fly, const std::atomic<bool>& stop)
        : wanted(jobs * waiting_per_job), done(jobs * waiting_per_job), flying_(jobs) {
        for (unsigned i = 0; i < jobs; ++i)
            threads_.emplace_back([this, &fly, &stop] {
                while (const auto number = wanted.pop()) {
                    if (stop) break;
                    auto result = flown(fly, *number);
                    if (!result || !done.push(std::move(*result))) break;
                }
                if (--flying_ == 0) done.close();
            });
    }
    CaseThreads(const CaseThreads&) = delete;
    CaseThreads& operator=(const CaseThreads&) = delete;
    ~CaseThreads() {
        wanted.close();
        done.close();
        for (auto& thread : threads_) thread.join();
    }

    BoundedQueue<std::uint64_t> wanted;
    BoundedQueue<CaseResult> done;

  private:
    std::atomic<unsigned> flying_;
    std::vector<std::thread> threads_;
};

}  // namespace

Result<Progress> run_campaign(CampaignStore& store, std::uint64_t cases, unsigned jobs, const Fly& fly,
                              const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell) {
    const auto began = Clock::now();
    Progress progress;
    progress.of = cases;
    std::vector<CaseResult> pending;
    auto pending_since = began;
    auto told = began;
    std::uint64_t next = 1;
    CaseThreads threads{jobs, fly, stop};

    const auto keep = [&]() -> Result<void> {
        const auto kept = store.add(pending);
        pending.clear();
        return kept;
    };
    for (;;) {
        while (next <= cases && !stop) {
            const auto had = store.has(next);
            if (!had) return had.error();
            if (!*had && !threads.wanted.try_push(next)) break;
            if (*had) ++progress.done;
            ++next;
        }
        if (next > cases || stop) threads.wanted.close();
        auto result = threads.done.pop_until(Clock::now() + tell_every);
        const auto now = Clock::now();
        const bool over = !result && threads.done.closed();
        if (result) {
            if (pending.empty()) pending_since = now;
            pending.push_back(std::move(*result));
            ++progress.done;
            ++progress.flown;
        }
        if (!pending.empty() && (over || now - pending_since >= keep_at_most))
            if (const auto kept = keep(); !kept) return kept.error();
        progress.wall_s = std::chrono::duration<double>{now - began}.count();
        if (tell && (over || now - told >= tell_every)) {
            told = now;
            tell(progress);
        }
        if (over) return progress;
    }
}

}  // namespace aeolis::server::campaign
