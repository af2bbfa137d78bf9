// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/case_worker.hpp"

#include "server/campaign/case_flights.hpp"
#include "server/cluster/case_messages.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace aeolis::server::cluster {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto case_wait = std::chrono::milliseconds{200};

/// A campaign that this worker takes part in.
struct CampaignAtWork {
    std::string queue;
    CampaignSubjects subjects;
    FlyCase fly;
};
using Campaigns = std::map<std::string, std::shared_ptr<CampaignAtWork>>;  // by subject of its order

class Worker {
  public:
    Worker(Engine& engine, const campaign::Identity& own, const BeginCampaign& begin, const WorkerSettings& settings,
           const std::atomic<bool>& stop)
        : engine_(engine), own_(own), begin_(begin), settings_(settings), kind_(kind_of(own)), stop_(stop) {}

    WorkerProgress run(const std::function<void(const WorkerProgress&)>& tell) {
        std::vector<std::jthread> threads;
        threads.reserve(settings_.jobs);
        for (unsigned i = 0; i < settings_.jobs; ++i) threads.emplace_back([this, i] { fly_cases(i); });
        auto spoken = Clock::now();
        while (!stop_) {
            const auto looked = look();
            progress_.waiting_for = looked ? "" : looked.error().message;
            if (Clock::now() - spoken >= settings_.speak_every) {
                spoken = Clock::now();
                speak();
            }
            if (tell) tell(so_far());
            for (auto left = settings_.look_every; left.count() > 0 && !stop_; left -= case_wait)
                std::this_thread::sleep_for(std::min<std::chrono::milliseconds>(left, case_wait));
        }
        threads.clear();
        return so_far();
    }

  private:
    WorkerProgress so_far() {
        progress_.flown = flown_;
        progress_.set_aside = set_aside_;
        progress_.wall_s = std::chrono::duration<double>{Clock::now() - began_}.count();
        auto now = progress_;
        const std::scoped_lock lock{mutex_};
        if (now.waiting_for.empty()) now.waiting_for = refusal_;
        return now;
    }

    /// Which campaigns the engine has now.
    Result<void> look() {
        if (!engine_.connected()) return Error{"the engine is away"};
        const auto subjects = engine_.subjects(campaign_stream, "aeolis.campaigns.>");
        if (!subjects) return subjects.error();
        Campaigns now;
        std::vector<std::string> left_out;
        for (const auto& subject : *subjects) {
            if (const auto known = campaigns_.find(subject); known != campaigns_.end()) {
                now.insert(*known);
                continue;
            }
            const auto octets = engine_.newest(campaign_stream, subject);
            if (!octets) return octets.error();
            if (!*octets) continue;
            auto made = campaign_of_order(subject, (*octets)->octets);
            if (made)
                now.emplace(subject, std::move(*made));
            else
                left_out.push_back(made.error().message);
        }
        progress_.campaigns = now.size();
        progress_.left_out = std::move(left_out);
        const std::scoped_lock lock{mutex_};
        campaigns_ = std::move(now);
        return {};
    }

    Result<std::shared_ptr<CampaignAtWork>> campaign_of_order(const std::string& subject, const std::string& octets) {
        v1::CampaignOrder order;
        if (!order.ParseFromString(octets)) return Error{subject + ": not the order of a campaign"};
        const auto other = [&](const char* what, const std::string& there, const std::string& here) {
            return Error{fmt::format("{}: {} {:.16} is needed, this is {:.16}", subject, what, there, here)};
        };
        if (order.program() != own_.program) return other("program", order.program(), own_.program);
        if (order.dictionary() != own_.dictionary) return other("dictionary", order.dictionary(), own_.dictionary);
        if (campaign_of(subject, kind_) != order.campaign())
            return Error{subject + ": the order is of another campaign"};
        auto fly = begin_(order);
        if (!fly) return fly.error();
        return std::make_shared<CampaignAtWork>(
            CampaignAtWork{order.campaign(), CampaignSubjects{kind_, order.campaign()}, std::move(*fly)});
    }

    /// So that the engine gives nobody else the cases in flight.
    void speak() {
        const std::scoped_lock lock{mutex_};
        for (auto* given : in_flight_) given->keep_waiting();
    }

    /// One thread: a case of each campaign in turn.
    void fly_cases(unsigned thread) {
        std::map<std::string, Consumer> consumers;
        for (std::size_t turn = thread; !stop_; ++turn) {
            std::vector<std::shared_ptr<CampaignAtWork>> campaigns;
            {
                const std::scoped_lock lock{mutex_};
                for (const auto& [subject, campaign] : campaigns_) campaigns.push_back(campaign);
            }
            std::erase_if(consumers, [&](const auto& one) {
                return std::ranges::none_of(campaigns,
                                            [&](const auto& campaign) { return campaign->queue == one.first; });
            });
            if (campaigns.empty() || !fly_one(*campaigns[turn % campaigns.size()], consumers))
                std::this_thread::sleep_for(case_wait);
        }
    }

    /// False: the engine is away, or the campaign is over.
    bool fly_one(CampaignAtWork& campaign, std::map<std::string, Consumer>& consumers) {
        auto known = consumers.find(campaign.queue);
        if (known == consumers.end()) {
            auto made = engine_.consumer(case_stream, campaign.subjects.case_consumer, campaign.subjects.cases);
            told(made ? Result<void>{} : made.error());
            if (!made) return false;
            known = consumers.emplace(campaign.queue, std::move(*made)).first;
        }
        auto given = known->second.next(1, case_wait);
        if (!given) {
            consumers.erase(known);
            return false;
        }
        for (auto& one : *given) answer(campaign, one);
        return true;
    }

    void answer(CampaignAtWork& campaign, Given& given) {
        v1::CaseOrder order;
        const auto octets = given.octets();
        if (!order.ParseFromArray(octets.data(), static_cast<int>(octets.size())) ||
            order.campaign() != campaign.queue) {
            (void)given.take();  // nobody can fly it
            return;
        }
        v1::CaseAnswer answer;
        answer.set_campaign(campaign.queue);
        answer.set_number(order.number());
        answer.set_worker(settings_.name);
        if (given.times() > tries_max) {
            answer.set_set_aside(fmt::format("given {} times without an answer", tries_max));
        } else {
            hold(&given);
            const auto result = flown(campaign, order.number());
            release(&given);
            if (!result) return give_back(campaign, std::move(answer), given);
            *answer.mutable_flown() = message_of(*result);
        }
        // The answer first: a case that is taken without one would be lost.
        const auto published = engine_.publish(campaign.subjects.answers, answer.SerializeAsString());
        told(published);
        if (!published) return;
        ++(answer.has_flown() ? flown_ : set_aside_);
        (void)given.take();
    }

    /// Somebody else may have it. A worker that ends says so: else three that end have the case set aside.
    void give_back(const CampaignAtWork& campaign, v1::CaseAnswer answer, Given& given) {
        answer.set_given_back(true);
        if (stop_) told(engine_.publish(campaign.subjects.answers, answer.SerializeAsString()));
        given.give_back();
    }

    /// None: it was abandoned, or could not begin.
    std::optional<campaign::CaseResult> flown(CampaignAtWork& campaign, std::uint64_t number) {
        try {
            return campaign.fly(number);
        } catch (const std::exception& error) {
            told(Error{fmt::format("case {}: {}", number, error.what())});
            return std::nullopt;
        }
    }

    /// What the threads have last been refused, for who looks at the progress.
    void told(const Result<void>& done) {
        const std::scoped_lock lock{mutex_};
        refusal_ = done ? "" : done.error().message;
    }

    void hold(Given* given) {
        const std::scoped_lock lock{mutex_};
        in_flight_.push_back(given);
    }
    void release(Given* given) {
        const std::scoped_lock lock{mutex_};
        std::erase(in_flight_, given);
    }

    Engine& engine_;
    const campaign::Identity& own_;
    const BeginCampaign& begin_;
    const WorkerSettings& settings_;
    const std::string kind_;
    const std::atomic<bool>& stop_;
    std::atomic<std::uint64_t> flown_{0}, set_aside_{0};
    WorkerProgress progress_;
    const Clock::time_point began_ = Clock::now();
    std::mutex mutex_;  // of the three below
    std::string refusal_;
    Campaigns campaigns_;
    std::vector<Given*> in_flight_;
};

}  // namespace

BeginCampaign landings(const dictionary::Dictionary& dictionary, const std::atomic<bool>& stop) {
    return [&dictionary, &stop](const v1::CampaignOrder& order) -> Result<FlyCase> {
        auto scenario = scenario_from_text(order.scenario_text(), "campaign " + order.campaign());
        if (!scenario) return scenario.error();
        struct Flights {
            simulation::Scenario scenario;
            std::once_flag begun{};
            std::unique_ptr<const campaign::CaseFlights> flights{};
        };
        const auto shared = std::make_shared<Flights>();
        shared->scenario = std::move(*scenario);
        return FlyCase{[shared, seed = order.seed(), &dictionary, &stop](std::uint64_t number) {
            std::call_once(shared->begun, [&] {
                shared->flights =
                    std::make_unique<const campaign::CaseFlights>(shared->scenario, seed, dictionary, stop);
            });
            return shared->flights->fly(number);
        }};
    };
}

WorkerProgress work(Engine& engine, const campaign::Identity& own, const BeginCampaign& begin,
                    const WorkerSettings& settings, const std::atomic<bool>& stop,
                    const std::function<void(const WorkerProgress&)>& tell) {
    return Worker{engine, own, begin, settings, stop}.run(tell);
}

}  // namespace aeolis::server::cluster
