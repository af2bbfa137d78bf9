// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/case_collector.hpp"

#include "server/cluster/case_messages.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <thread>

namespace aeolis::server::cluster {
namespace {

using Clock = std::chrono::steady_clock;
using campaign::Progress;

constexpr std::size_t ahead = 2000;  // cases in the queue: minutes of work for hundreds of processors
constexpr std::size_t choose_below = 1500;
constexpr std::size_t answers_at_once = 256;
constexpr auto tell_every = std::chrono::milliseconds{100};
constexpr auto engine_again = std::chrono::milliseconds{500};

class Collector {
  public:
    Collector(campaign::CampaignStore& store, const campaign::Identity& identity, std::uint64_t cases, Engine& engine,
              std::string queue, const CollectorTimes& times)
        : store_(store), identity_(identity), cases_(cases), engine_(engine), queue_(std::move(queue)),
          subjects_(kind_of(identity), queue_), times_(times) {
        progress_.of = cases;
    }

    Result<Progress> run(const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell) {
        const auto stored = collect(stop, tell);
        close();
        if (!stored) return stored.error();
        told_ = {};
        report(tell);
        return std::move(progress_);
    }

  private:
    /// The Error is the store's.
    Result<void> collect(const std::atomic<bool>& stop, const std::function<void(const Progress&)>& tell) {
        bool open = false;
        while (!stop) {
            if (const auto chosen = choose(); !chosen) return chosen;
            if (waiting_.empty() && fresh_.empty()) break;
            if (!open) open = told(opened());
            if (open) open = told(listen());
            if (open) open = told(queue_chosen());
            if (!open) std::this_thread::sleep_for(engine_again);
            if (const auto kept = keep(false); !kept) return kept;
            if (open && Clock::now() - heard_ > times_.quiet) open = told(choose_lost_again());
            report(tell);
        }
        return keep(true);
    }

    /// The engine's part: an Error is told and waited for, never the end.
    bool told(const Result<void>& done) {
        progress_.waiting_for = done ? "" : done.error().message;
        return done.ok();
    }

    Result<void> opened() {
        if (const auto made = engine_.make_stream(campaign_stream, "aeolis.campaigns.>", Retention::newest); !made)
            return made;
        if (const auto made = engine_.make_stream(case_stream, "aeolis.cases.>", Retention::until_taken); !made)
            return made;
        if (const auto made = engine_.make_stream(answer_stream, "aeolis.answers.>", Retention::until_taken); !made)
            return made;
        // What an earlier call left in the queue is queued anew below.
        if (const auto cleared = engine_.clear(case_stream, subjects_.cases); !cleared) return cleared;
        if (const auto made =
                engine_.make_consumer(case_stream, subjects_.case_consumer, subjects_.cases, times_.again_after);
            !made)
            return made;
        if (const auto made =
                engine_.make_consumer(answer_stream, subjects_.answer_consumer, subjects_.answers, times_.again_after);
            !made)
            return made;
        auto consumer = engine_.consumer(answer_stream, subjects_.answer_consumer, subjects_.answers);
        if (!consumer) return consumer.error();
        done_.clear();  // of the consumer before; what was not taken is given again, and then known
        answers_.emplace(std::move(*consumer));
        heard_ = Clock::now();
        chosen_ = waiting_;
        return publish_order();
    }

    /// The newest message of its subject: again does no harm.
    Result<void> publish_order() {
        v1::CampaignOrder order;
        order.set_campaign(queue_);
        order.set_scenario_text(identity_.scenario_text);
        order.set_seed(identity_.seed);
        order.set_dictionary(identity_.dictionary);
        order.set_program(identity_.program);
        return engine_.publish(subjects_.order, order.SerializeAsString());
    }

    /// Chooses more cases that the store lacks, when few wait.
    Result<void> choose() {
        if (waiting_.size() >= choose_below) return {};
        for (; next_ <= cases_ && waiting_.size() < ahead; ++next_) {
            const auto had = store_.has(next_);
            if (!had) return had.error();
            if (*had) {
                ++progress_.done;
            } else {
                waiting_.insert(next_);
                chosen_.insert(next_);
            }
        }
        return {};
    }

    Result<void> queue_chosen() {
        if (chosen_.empty()) return {};
        std::vector<std::string> messages;
        v1::CaseOrder order;
        order.set_campaign(queue_);
        for (const auto number : chosen_) {
            order.set_number(number);
            messages.push_back(order.SerializeAsString());
        }
        const auto published = engine_.publish(subjects_.cases, messages);
        if (published) chosen_.clear();
        return published;
    }

    /// Takes the answers that are there, also those that an earlier call left: what they answer is not queued again.
    Result<void> listen() {
        if (!engine_.connected()) return Error{"the engine is away"};
        for (bool more = true; more;) {
            auto given = answers_->next(answers_at_once, tell_every);
            if (!given) return given.error();
            for (auto& one : *given) take(std::move(one));
            more = given->size() == answers_at_once && done_.size() < ahead;
        }
        return {};
    }

    void take(Given given) {
        v1::CaseAnswer answer;
        const auto octets = given.octets();
        const bool understood = answer.ParseFromArray(octets.data(), static_cast<int>(octets.size())) &&
                                answer.campaign() == queue_ && answer.number() >= 1 && answer.number() <= cases_ &&
                                answer.answer_case() != v1::CaseAnswer::ANSWER_NOT_SET;
        auto result = understood && answer.has_flown() ? result_of(answer) : Error{"not a flown case"};
        if (!understood || (answer.has_flown() && !result)) {
            ++progress_.refused_answers;
            done_.push_back(std::move(given));
            return;
        }
        heard_ = Clock::now();
        if (answer.given_back()) {
            given_back_.insert(answer.number());
            done_.push_back(std::move(given));
            return;
        }
        if (answer.answer_case() == v1::CaseAnswer::kSetAside && given_back_.erase(answer.number()) > 0) {
            // Not all of its tries were tries: it is queued anew, and counted from one.
            if (waiting_.contains(answer.number())) chosen_.insert(answer.number());
            done_.push_back(std::move(given));
            return;
        }
        chosen_.erase(answer.number());
        if (waiting_.erase(answer.number()) == 0 && !(answer.has_flown() && no_longer_aside(answer.number()))) {
            done_.push_back(std::move(given));  // stored already: a case that was given twice
            return;
        }
        if (answer.has_flown()) {
            if (fresh_.empty()) fresh_since_ = heard_;
            fresh_.push_back(std::move(*result));
            ++progress_.done;
            ++progress_.flown;
            count(answer.worker());
        } else {
            progress_.set_aside.push_back({answer.number(), answer.set_aside()});
        }
        done_.push_back(std::move(given));
    }

    /// An answer that comes after its case was set aside is as good as any.
    bool no_longer_aside(std::uint64_t number) {
        return std::erase_if(progress_.set_aside, [&](const auto& one) { return one.number == number; }) > 0;
    }

    void count(const std::string& worker) {
        const auto known = std::ranges::find(progress_.workers, worker, &campaign::WorkerShare::name);
        if (known != progress_.workers.end())
            ++known->flown;
        else
            progress_.workers.push_back({worker, 1});
    }

    /// Stores what was answered, then takes it out of the queue.
    Result<void> keep(bool now) {
        if (!fresh_.empty() && !now && Clock::now() - fresh_since_ < times_.store_every) return {};
        if (!fresh_.empty())
            if (const auto added = store_.add(fresh_); !added) return added;
        fresh_.clear();
        for (auto& given : done_)
            if (!given.take()) break;  // given again, and then known as stored
        done_.clear();
        return {};
    }

    /// Has the cases that wait queued again, once neither the queue nor a worker has any of them.
    Result<void> choose_lost_again() {
        heard_ = Clock::now();
        const auto untaken = engine_.untaken(case_stream, subjects_.case_consumer);
        if (!untaken) return untaken.error();
        if (*untaken == 0) chosen_ = waiting_;
        return publish_order();
    }

    void close() {
        done_.clear();  // before their consumer
        answers_.reset();
        (void)engine_.clear(campaign_stream, subjects_.order);
        (void)engine_.clear(case_stream, subjects_.cases);
        (void)engine_.remove_consumer(case_stream, subjects_.case_consumer);
        if (!waiting_.empty() || !fresh_.empty()) return;  // answers that are not stored are for the next call
        (void)engine_.clear(answer_stream, subjects_.answers);
        (void)engine_.remove_consumer(answer_stream, subjects_.answer_consumer);
    }

    void report(const std::function<void(const Progress&)>& tell) {
        const auto now = Clock::now();
        progress_.wall_s = std::chrono::duration<double>{now - began_}.count();
        if (!tell || now - told_ < tell_every) return;
        told_ = now;
        tell(progress_);
    }

    campaign::CampaignStore& store_;
    const campaign::Identity& identity_;
    const std::uint64_t cases_;
    Engine& engine_;
    const std::string queue_;
    const CampaignSubjects subjects_;
    const CollectorTimes times_;
    std::optional<Consumer> answers_;
    std::uint64_t next_ = 1;                   // the first number that was not looked at
    std::set<std::uint64_t> waiting_;          // chosen and not answered
    std::set<std::uint64_t> chosen_;           // of these, not queued
    std::set<std::uint64_t> given_back_;       // of these, by workers that ended
    std::vector<campaign::CaseResult> fresh_;  // answered, not stored
    std::vector<Given> done_;                  // to be taken once `fresh_` is stored
    Progress progress_;
    const Clock::time_point began_ = Clock::now();
    Clock::time_point heard_ = began_, fresh_since_ = began_, told_{};
};

}  // namespace

Result<Progress> collect(campaign::CampaignStore& store, const campaign::Identity& identity, std::uint64_t cases,
                         Engine& engine, const std::atomic<bool>& stop,
                         const std::function<void(const Progress&)>& tell, const CollectorTimes& times) {
    auto queue = store.queue();
    if (!queue) return queue.error();
    return Collector{store, identity, cases, engine, std::move(*queue), times}.run(stop, tell);
}

}  // namespace aeolis::server::cluster
