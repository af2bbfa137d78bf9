// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/forecast_service.hpp"

#include "server/base/json.hpp"
#include "server/base/wall_clock.hpp"
#include "server/campaign/campaign_order.hpp"
#include "server/rehearsal/again_of.hpp"
#include "server/rehearsal/command_messages.hpp"
#include "server/rehearsal/kept_requests.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/shadow/forecast_report.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server::shadow {
namespace {

constexpr std::uint64_t usual_cases = 32;
constexpr const char* stopped = "the forecast was cancelled";

std::string name_of(v1::Forecast::State state) {
    return v1::Forecast::State_Name(state);
}

bool is(const archive::ForecastRecord& record, archive::RunId run, std::uint64_t number) {
    return record.run == run && record.number == number;
}

Result<Assumption> assumption_of(const v1::ForecastRequest& request, const simulation::Scenario& scenario) {
    Assumption assumption;
    for (int i = 0; i < request.commands_size(); ++i) {
        auto message = request.commands(i);
        message.set_armed(true);  // who assumes a command has armed and confirmed it
        message.set_confirmation(message.command());
        auto command = request_of(message, {}, true);
        if (!command) return Error{fmt::format("commands[{}]: {}", i, command.error().message)};
        assumption.commands.push_back(std::move(*command));
    }
    for (int i = 0; i < request.faults_size(); ++i) {
        auto fault = fault_from_message(request.faults(i), scenario);
        if (!fault) return Error{fmt::format("faults[{}]: {}", i, fault.error().message)};
        assumption.faults.push_back(*fault);
    }
    return assumption;
}

}  // namespace

Result<ReadForecast> read_forecast(const v1::ForecastRequest& request, const v1::RunState& state,
                                   archive::FlownRun run) {
    ReadForecast forecast;
    if (run.scenario_text.empty())
        return Error{fmt::format("run {} follows another mission: nothing can be flown again", run.run.value)};
    auto scenario = scenario_from_text(run.scenario_text, fmt::format("the scenario of run {}", run.run.value));
    if (!scenario) return scenario.error();
    if (scenario->test_venue == simulation::TestVenue::performance)
        return Error{"the test venue performance runs by the real clock: no forecast"};
    if (scenario->test_venue == simulation::TestVenue::gnc_alone)
        return Error{"the test venue gnc_alone has no computer: no forecast"};
    v1::Fork instant;
    instant.set_at(request.at());
    if (request.at().empty()) {
        if (!state.has_clocks())
            return Error{"at: an instant of the run is wanted, like E+3:10; only a run that goes on has a now"};
        instant.set_at(fmt::format("{}", state.clocks().sclk()));
    }
    const auto at = fork_point_of(instant, state);
    if (!at) return at.error();
    auto assumption = assumption_of(request, *scenario);
    if (!assumption) return assumption.error();
    forecast.cycle = at->cycle;
    forecast.assumption = std::move(*assumption);
    forecast.scenario = std::move(*scenario);
    forecast.order.cases = request.cases() == 0 ? usual_cases : request.cases();
    forecast.order.seed = request.seed() == 0 ? 1 : request.seed();
    forecast.order.jobs = std::max(1U, std::thread::hardware_concurrency());
    forecast.order.idle = true;
    if (forecast.order.cases > forecast_cases_max)
        return Error{fmt::format("cases: {} is more than {}", forecast.order.cases, forecast_cases_max)};
    for (const auto& command : request.commands()) forecast.assumed.push_back(to_json(command));
    for (const auto& fault : request.faults()) forecast.assumed.push_back(to_json(fault));
    forecast.record.run = run.run;
    forecast.record.asked = wall_clock_text();
    forecast.record.at_e_s = at->e_s;
    forecast.record.request = to_json(request);
    forecast.record.state = name_of(v1::Forecast::queued);
    forecast.run = std::move(run);
    return forecast;
}

ForecastService::ForecastService(const dictionary::Dictionary& dictionary, Keep keep)
    : dictionary_(dictionary), keep_(std::move(keep)), thread_([this] { work(); }) {}

ForecastService::~ForecastService() {
    {
        const std::scoped_lock lock{mutex_};
        over_ = true;
        stop_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

std::string ForecastService::full() const {
    const std::scoped_lock lock{mutex_};
    if (waiting_.size() < waiting_max) return {};
    return fmt::format("{} forecasts wait already: cancel one, or wait until one is ready", waiting_.size());
}

void ForecastService::add(ReadForecast forecast) {
    const std::scoped_lock lock{mutex_};
    waiting_.push_back(std::move(forecast));
    changed_.notify_all();
}

bool ForecastService::cancel(archive::RunId run, std::uint64_t number) {
    std::optional<archive::ForecastRecord> removed;
    {
        const std::scoped_lock lock{mutex_};
        if (flying_ && is(*flying_, run, number)) {
            if (flown_) return false;
            cancelled_ = true;
            stop_ = true;
            return true;
        }
        const auto found =
            std::ranges::find_if(waiting_, [&](const ReadForecast& each) { return is(each.record, run, number); });
        if (found == waiting_.end()) return false;
        removed = std::move(found->record);
        waiting_.erase(found);
    }
    removed->state = name_of(v1::Forecast::cancelled);
    removed->ended = wall_clock_text();
    keep_(*removed);
    return true;
}

v1::Forecast ForecastService::now(const archive::ForecastRecord& record) const {
    v1::Forecast told;
    told.set_run(record.run.value);
    told.set_forecast(record.number);
    told.set_at_e_s(record.at_e_s);
    told.set_asked(record.asked);
    told.set_asked_by(record.asked_by);
    told.set_ended(record.ended);
    told.set_reason(record.reason);
    static_cast<void>(from_json(record.request, *told.mutable_request()));  // as it was written here
    if (!record.result.empty()) static_cast<void>(from_json(record.result, *told.mutable_result()));
    auto state = v1::Forecast::queued;
    if (!v1::Forecast::State_Parse(record.state, &state)) state = v1::Forecast::failed;
    if (state == v1::Forecast::queued) {
        const std::scoped_lock lock{mutex_};
        if (flying_ && is(*flying_, record.run, record.number)) {
            state = v1::Forecast::flying;
            told.set_done(progress_.done);
            told.set_of(progress_.of);
            told.set_without(progress_.without);
            told.set_within_without(progress_.within_without);
            told.set_with(progress_.with);
            told.set_within_with(progress_.within_with);
        } else if (std::ranges::none_of(waiting_, [&](const ReadForecast& each) {
                       return is(each.record, record.run, record.number);
                   })) {
            state = v1::Forecast::abandoned;
        }
    }
    told.set_state(state);
    return told;
}

void ForecastService::work() {
    campaign::use_idle_priority();
    for (;;) {
        ReadForecast next;
        {
            std::unique_lock lock{mutex_};
            changed_.wait(lock, [this] { return over_ || !waiting_.empty(); });
            if (over_) return;
            next = std::move(waiting_.front());
            waiting_.pop_front();
            flying_ = next.record;
            progress_ = {};
            stop_ = cancelled_ = flown_ = false;
        }
        fly(next);
        bool keep = true;
        {
            const std::scoped_lock lock{mutex_};
            flown_ = true;
            if (cancelled_) {
                next.record.state = name_of(v1::Forecast::cancelled);
                next.record.reason.clear();
                next.record.result.clear();
            }
            keep = !over_ || next.record.state == name_of(v1::Forecast::ready);
        }
        if (keep) keep_(next.record);
        const std::scoped_lock lock{mutex_};
        flying_.reset();
        if (over_) return;
    }
}

void ForecastService::fly(ReadForecast& forecast) {
    const auto& run = forecast.run;
    Result<TruthForecast> flown = Error{stopped};
    {
        Rehearsal rehearsal{forecast.scenario, run.seed, run.case_number, dictionary_, {}, run.clock};
        if (const auto there = fly_again(rehearsal, run, forecast.cycle, [this] { return stop_.load(); }); !there)
            flown = there.error();
        else
            flown = forecast_from_truth(rehearsal.flight(), forecast.scenario, dictionary_, forecast.assumption,
                                        forecast.order, stop_, [this](const ForecastProgress& progress) {
                                            const std::scoped_lock lock{mutex_};
                                            progress_ = progress;
                                        });
    }
    auto& record = forecast.record;
    record.ended = wall_clock_text();
    record.state = name_of(flown ? v1::Forecast::ready : v1::Forecast::failed);
    if (!flown) {
        record.reason = flown.error().message;
        return;
    }
    const ForecastCall call{forecast.scenario.name, run.seed, forecast.order, forecast.assumed};
    record.result = forecast_json(*flown, forecast.scenario.limits, call);
}

}  // namespace aeolis::server::shadow
