// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/prediction_service.hpp"

#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <iterator>
#include <sys/resource.h>
#include <unistd.h>
#include <utility>

namespace aeolis::server {
namespace {

constexpr int niceness = 10;  // chosen: behind the run's threads, before the campaign's

}  // namespace

PredictionService::PredictionService(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

PredictionService::~PredictionService() {
    {
        const std::lock_guard lock{mutex_};
        over_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
}

PredictionService::Answer PredictionService::prediction(const simulation::Scenario& scenario) {
    auto expected = expected_scenario(scenario);
    auto key = scenario_to_text(expected);
    const std::lock_guard lock{mutex_};
    const auto known = std::ranges::find_if(kept_, [&](const auto& each) { return each->key == key; });
    if (known != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, known);
        return kept_.front()->answer;
    }
    if (over_) return {};
    if (kept_.size() >= kept_max) {
        // Never one that waits or is under way: clients that ask in turn would drop each other's for ever.
        const auto oldest =
            std::ranges::find_if(kept_.rbegin(), kept_.rend(), [](const auto& each) { return each->known; });
        if (oldest == kept_.rend()) return {};
        kept_.erase(std::next(oldest).base());
    }
    kept_.push_front(std::make_shared<Kept>(Kept{std::move(key), std::move(expected), false, {}}));
    if (!thread_.joinable()) thread_ = std::thread{[this] { fly(); }};
    changed_.notify_one();
    return {};
}

std::uint64_t PredictionService::flown() const {
    const std::lock_guard lock{mutex_};
    return flown_;
}

void PredictionService::fly() {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
    const auto next = [this] { return std::ranges::find_if(kept_, [](const auto& each) { return !each->known; }); };
    std::unique_lock lock{mutex_};
    for (;;) {
        changed_.wait(lock, [&] { return over_ || next() != kept_.end(); });
        if (over_) return;
        const auto wanted = *next();
        lock.unlock();
        auto flight = fly_nominally(wanted->expected, dictionary_, [this] {
            const std::lock_guard looking{mutex_};
            return over_;
        });
        lock.lock();
        if (over_) return;
        ++flown_;
        wanted->known = true;
        if (flight)
            wanted->answer.flight = std::make_shared<const NominalFlight>(std::move(*flight));
        else
            wanted->answer.none = flight.error().message;
    }
}

}  // namespace aeolis::server
