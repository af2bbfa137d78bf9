// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/forecast.hpp"

#include "server/campaign/campaign_order.hpp"
#include "server/campaign/case_flights.hpp"
#include "server/shadow/prospect.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/vectors.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <deque>
#include <fmt/format.h>
#include <mutex>
#include <thread>

namespace aeolis::server::shadow {
namespace {

using simulation::Outcome;

constexpr std::uint64_t cycles_between_looks = 64;
constexpr std::int64_t course_ticks = 64;  // a second
constexpr auto tell_every = std::chrono::milliseconds{100};

/// A landing under way, to be copied: with its command path until no command is on its way, then alone and unheard.
class Flight {
  public:
    Flight(const ScriptedLanding& landing, const dictionary::Dictionary& dictionary)
        : commanded_(landing), firings_(dictionary) {
        firings_.read(landing.landing().recording());
    }

    void assume(const Assumption& assumption) {
        for (const simulation::Fault& fault : assumption.faults) commanded_->inject(fault);
        unsent_.assign(assumption.commands.begin(), assumption.commands.end());
        send_next();
    }

    void step() {
        if (commanded_) {
            commanded_->hear(commanded_->step());
            commanded_->take_stages();
        } else {
            unheard_->step();
        }
        const simulation::CycleReport& report = landing().report();
        firings_.read(report.recorded);
        events_.insert(events_.end(), report.events.begin(), report.events.end());
        if (++cycles_ % cycles_between_looks != 0 || !commanded_ || !quiet()) return;
        if (!unsent_.empty()) return send_next();
        unheard_.emplace(commanded_->landing());
        unheard_->fly_unheard();
        commanded_.reset();
    }

    void draw(std::uint64_t seed, std::uint64_t case_number,
              const std::optional<simulation::StateKnowledge>& knowledge) {
        const auto each = [&](auto& flown) {
            if (knowledge || landing().dispersed())
                flown.redraw(seed, case_number, knowledge);
            else
                flown.take_case(case_number);
        };
        if (commanded_)
            each(*commanded_);
        else
            each(*unheard_);
    }

    const simulation::Landing& landing() const { return commanded_ ? commanded_->landing() : *unheard_; }
    const RecordedFirings& firings() const { return firings_; }
    const std::vector<simulation::TruthEvent>& events() const { return events_; }
    std::uint64_t cycles() const { return cycles_; }
    const std::string& refusal() const { return refusal_; }  ///< of a command of the assumption; empty: none

  private:
    bool quiet() const {
        const commands::CommandGateway& gateway = commanded_->gateway();
        return commanded_->script_sent() && gateway.queued() == 0 && gateway.at_uplink() == 0 &&
               !gateway.awaits_answers();
    }

    void send_next() {
        if (unsent_.empty()) return;
        const commands::Request request = std::move(unsent_.front());
        unsent_.pop_front();
        const commands::Reply reply = commanded_->submit(request);
        if (reply.accepted) return;
        refusal_ = fmt::format("{} is refused: {}", request.command, reply.reason);
        unsent_.clear();
    }

    std::optional<ScriptedLanding> commanded_;
    std::optional<simulation::Landing> unheard_;
    std::deque<commands::Request> unsent_;
    RecordedFirings firings_;
    std::vector<simulation::TruthEvent> events_;
    std::uint64_t cycles_ = 0;
    std::string refusal_;
};

/// Collects the seconds of a case.
class CourseRecord {
  public:
    CourseRecord(Course& course, const simulation::Scenario& scenario) : course_(course), scenario_(scenario) {}

    void look(const simulation::Landing& landing) {
        if (landing.sclk().ticks() % course_ticks != 0) return;
        const simulation::TruthState truth = landing.truth();
        const auto p = simulation::vector3(truth.p_MoB_M_m), v = simulation::vector3(truth.v_MB_M_mps);
        if (course_.seconds.empty()) course_.first = truth.sclk;
        course_.seconds.push_back({static_cast<float>(p.norm() - scenario_.target.radius_m),
                                   static_cast<float>(v.norm()),
                                   simulation::earth_range_rate_mps(p, v, truth.sclk - scenario_.entry_sclk)});
    }
    void end(const RecordedFirings& firings, const dictionary::Dictionary& dictionary) {
        course_.fired.resize(dictionary.timeline.size());
        for (const RecordedFiring& each : firings.all())
            if (each.row < course_.fired.size()) course_.fired[each.row] = Sclk{each.fired_sclk};
    }

  private:
    Course& course_;
    const simulation::Scenario& scenario_;
};

/// SCLK at which the cases of a flight part.
double apart_sclk(const simulation::Landing& landing, const simulation::Scenario& scenario, bool by_ground) {
    if (!by_ground && !landing.dispersed()) return scenario.entry_sclk.seconds - *scenario.disperse_before_entry_s;
    return std::max(landing.sclk().seconds, scenario.entry_sclk.seconds - airless_before_entry_s);
}

/// Seconds of processor time of this thread.
double thread_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    constexpr double nanosecond_s = 1.0e-9;
    return static_cast<double>(now.tv_sec) + nanosecond_s * static_cast<double>(now.tv_nsec);
}

/// Works off the numbers 0 … count − 1 on some threads.
class Crew {
  public:
    Crew(const ForecastOrder& order, std::size_t count, std::function<void(std::size_t)> work)
        : count_(count), work_(std::move(work)) {
        const auto members = std::min<std::size_t>(std::max(1U, order.jobs), count);
        threads_.reserve(members);
        for (std::size_t i = 0; i < members; ++i)
            threads_.emplace_back([this, idle = order.idle] {
                if (idle) campaign::use_idle_priority();
                run();
            });
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew() {
        for (auto& thread : threads_) thread.join();
    }

    /// Returns once all is done. `look`: ten times a second, on the calling thread.
    void wait(const std::function<void()>& look) {
        std::unique_lock lock{mutex_};
        while (!ended_.wait_for(lock, tell_every, [&] { return done_ == count_; })) {
            lock.unlock();
            look();
            lock.lock();
        }
    }
    double processor_s() {
        for (auto& thread : threads_) thread.join();
        threads_.clear();
        return processor_s_;
    }

  private:
    void run() {
        for (std::size_t i = next_++; i < count_; i = next_++) {
            work_(i);
            const std::scoped_lock lock{mutex_};
            if (++done_ == count_) ended_.notify_all();
        }
        const std::scoped_lock lock{mutex_};
        processor_s_ += thread_s();
    }

    std::size_t count_;
    std::function<void(std::size_t)> work_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;
    std::condition_variable ended_;
    std::size_t done_ = 0;      ///< under mutex_
    double processor_s_ = 0.0;  ///< under mutex_
    std::vector<std::thread> threads_;
};

/// One side: a flight that its cases share, and the cases.
struct Side {
    std::optional<Flight> shared;
    std::string lost;  ///< why the shared flight could not be flown
    std::vector<campaign::CaseResult> cases;
    std::vector<std::string> refusals;  ///< by case
    std::atomic<std::uint64_t> done{0}, within{0};
};

Result<FlownForecast> fly_cases(const ScriptedLanding& landing,
                                const std::optional<simulation::StateKnowledge>& knowledge,
                                const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary,
                                const Assumption& assumption, const ForecastOrder& order, const std::atomic<bool>& stop,
                                const std::function<void(const ForecastProgress&)>& tell,
                                std::vector<Course>* courses = nullptr) {
    if (landing.landing().outcome() != Outcome::running) return Error{"the landing is over: nothing is to come"};
    if (order.cases == 0 || order.cases > forecast_cases_max)
        return Error{fmt::format("cases: {} is not between 1 and {}", order.cases, forecast_cases_max)};
    const auto began = std::chrono::steady_clock::now();
    const double apart_s = apart_sclk(landing.landing(), scenario, knowledge.has_value());
    std::array<Side, 2> sides;
    const std::size_t side_count = assumption.empty() ? 1 : 2;
    const auto guarded = [](const auto& work) -> std::string {
        try {
            work();
            return {};
        } catch (const CheckFailed& bug) {
            return text_of_bug(bug);
        } catch (const std::exception& error) {
            return std::string{"the simulation ended: "} + error.what();
        }
    };

    const auto fly_shared = [&](std::size_t number) {
        Side& side = sides[number];
        side.lost = guarded([&] {
            side.shared.emplace(landing, dictionary);
            Flight& flight = *side.shared;
            if (number == 1) flight.assume(assumption);
            while (flight.landing().outcome() == Outcome::running && flight.landing().sclk().seconds < apart_s &&
                   flight.refusal().empty() && !stop)
                flight.step();
        });
    };
    const auto fly_case = [&](std::size_t place) {
        if (stop) return;
        Side& side = sides[place % side_count];
        const std::uint64_t number = place / side_count + 1;
        campaign::CaseResult& result = side.cases[number - 1];
        std::uint64_t cycles = 0;
        const std::string lost = guarded([&] {
            Flight flight{*side.shared};
            flight.draw(order.seed, number, knowledge);
            std::optional<CourseRecord> course;
            if (courses != nullptr) course.emplace((*courses)[number - 1], scenario);
            while (flight.landing().outcome() == Outcome::running && !stop) {
                if (course) course->look(flight.landing());
                flight.step();
                cycles = flight.cycles();
            }
            if (stop) return;
            if (course) course->end(flight.firings(), dictionary);
            result =
                campaign::result_of(flight.landing(), flight.firings(), flight.events(), scenario, dictionary, apart_s);
            side.refusals[number - 1] = flight.refusal();
        });
        if (!lost.empty()) {
            result.outcome = simulation::name_of(Outcome::lost);
            result.reason = lost;
        }
        result.number = number;
        result.end_cycle = cycles;
        ++side.done;
        if (within_limits(result)) ++side.within;
    };
    const auto told = [&] {
        if (!tell) return;
        const auto& [without, with] = sides;
        tell(
            {without.done + with.done, order.cases * side_count, without.done, with.done, without.within, with.within});
    };

    FlownForecast forecast;
    {
        Crew crew{order, side_count, fly_shared};
        crew.wait(told);
        forecast.processor_s += crew.processor_s();
    }
    for (const Side& side : sides)
        if (!side.lost.empty()) return Error{side.lost};
    if (sides[1].shared && !sides[1].shared->refusal().empty()) return Error{sides[1].shared->refusal()};
    for (Side& side : sides) {
        side.cases.resize(order.cases);
        side.refusals.resize(order.cases);
    }
    {
        Crew crew{order, order.cases * side_count, fly_case};
        crew.wait(told);
        forecast.processor_s += crew.processor_s();
    }
    if (stop) return Error{"the forecast was stopped: nothing is told of fewer cases than were asked for"};
    for (const std::string& refusal : sides[1].refusals)
        if (!refusal.empty()) return Error{refusal};
    told();
    forecast.from_e_s = landing.landing().sclk() - scenario.entry_sclk;
    forecast.apart_e_s = apart_s - scenario.entry_sclk.seconds;
    forecast.without = std::move(sides[0].cases);
    if (side_count == 2) forecast.with = std::move(sides[1].cases);
    forecast.wall_s = std::chrono::duration<double>{std::chrono::steady_clock::now() - began}.count();
    return forecast;
}

}  // namespace

const char* name_of(Basis basis) {
    return basis == Basis::truth ? "truth" : "telemetry";
}

Result<FlownForecast> forecast_from_truth(const ScriptedLanding& landing, const simulation::Scenario& scenario,
                                          const dictionary::Dictionary& dictionary, const Assumption& assumption,
                                          const ForecastOrder& order, const std::atomic<bool>& stop,
                                          const std::function<void(const ForecastProgress&)>& tell) {
    return fly_cases(landing, {}, scenario, dictionary, assumption, order, stop, tell);
}

Result<std::vector<Course>> courses_by_ground(const ScriptedLanding& landing,
                                              const simulation::StateKnowledge& knowledge,
                                              const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary, const ForecastOrder& order,
                                              const std::atomic<bool>& stop) {
    std::vector<Course> courses(order.cases);
    const auto flown =
        fly_cases(landing, knowledge, ground_scenario(scenario), dictionary, {}, order, stop, {}, &courses);
    if (!flown) return flown.error();
    std::erase_if(courses, [](const Course& each) { return each.fired.empty(); });  // a check failed
    return courses;
}

Result<FlownForecast> forecast_by_ground(const GroundFlight& ground, const simulation::Scenario& scenario,
                                         const dictionary::Dictionary& dictionary, const Assumption& assumption,
                                         const ForecastOrder& order, const std::atomic<bool>& stop,
                                         const std::function<void(const ForecastProgress&)>& tell) {
    auto forecast = fly_cases(ground.rehearsal->flight(), ground.knowledge, ground_scenario(scenario), dictionary,
                              assumption, order, stop, tell);
    if (!forecast) return forecast;
    forecast->basis = Basis::telemetry;
    forecast->knowledge = ground.knowledge;
    if (ground.heard) forecast->heard_e_s = *ground.heard - scenario.entry_sclk;
    return forecast;
}

}  // namespace aeolis::server::shadow
