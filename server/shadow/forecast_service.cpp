// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/forecast_service.hpp"

#include "server/archive/items.hpp"
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
constexpr auto keep_again = std::chrono::seconds{1};
constexpr std::size_t packets_read = 1'000;  // of the archive at a time

std::string name_of(v1::Forecast::State state) {
    return v1::Forecast::State_Name(state);
}

bool is(const archive::ForecastRecord& record, archive::RunId run, std::uint64_t number) {
    return record.run == run && record.number == number;
}

Result<Assumption> assumption_of(const v1::ForecastRequest& request, const v1::RunState& run,
                                 const simulation::Scenario& scenario) {
    Assumption assumption;
    const archive::RunClocks clocks = archive::clocks_of(run);
    for (int i = 0; i < request.commands_size(); ++i) {
        auto message = request.commands(i);
        message.set_armed(true);  // who assumes a command has armed and confirmed it
        message.set_confirmation(message.command());
        auto command = request_of(message, clocks, {}, true);
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

/// The packets that ground received of a run, in order, to be held against what it receives when flown again.
class StoredPackets {
  public:
    StoredPackets(archive::Reader reader, archive::RunId run, bool goes_on)
        : reader_(std::move(reader)), run_(run), goes_on_(goes_on) {}

    Result<void> look(const telemetry::Received& received) {
        for (const auto& packet : received.packets) {
            if (next_ == page_.size())
                if (auto read = read_page(); !read) return read;
            if (page_.empty()) {
                if (goes_on_) return {};  // what it has just received is not stored yet
                return Error{fmt::format("run {} has no more packets from there on", run_.value)};
            }
            if (page_[next_++] != packet.octets)
                return Error{
                    fmt::format("run {}: flown again, packet {} that ground receives is not what it was: the run "
                                "is of another program",
                                run_.value, count_)};
            ++count_;
        }
        return {};
    }

  private:
    Result<void> read_page() {
        auto page = reader_.received_octets(run_, after_, packets_read);
        if (!page) return page.error();
        page_ = std::move(*page);
        next_ = 0;
        return {};
    }

    archive::Reader reader_;
    archive::RunId run_;
    bool goes_on_;
    archive::Sequence after_ = 0;
    std::vector<std::vector<std::uint8_t>> page_;
    std::size_t next_ = 0;
    std::uint64_t count_ = 1;
};

}  // namespace

Result<ReadForecast> read_forecast(const v1::ForecastRequest& request, const v1::RunState& state,
                                   archive::Reader& reader) {
    ReadForecast forecast;
    auto flown = reader.flown(archive::RunId{static_cast<std::uint32_t>(state.run())});
    if (!flown) return flown.error();
    archive::FlownRun& run = *flown;
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
    const auto at = fork_point_of(instant, state, "at");
    if (!at) return at.error();
    if (!state.has_clocks())
        if (const auto reached = check_flown(reader, state, *at, "at"); !reached) return reached.error();
    if (state.has_clocks() && at->e_s > state.clocks().e_s() + seconds_per_tick)
        return Error{fmt::format("at: E{:+.1f} s is yet to come: run {} is at E{:+.1f} s", at->e_s, state.run(),
                                 state.clocks().e_s())};
    forecast.goes_on = state.has_clocks();
    forecast.now = request.at().empty();
    auto assumption = assumption_of(request, state, *scenario);
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
    forecast.record.truth = request.from() == v1::ForecastRequest::truth;
    forecast.record.asked = wall_clock_text();
    forecast.record.at_e_s = at->e_s;
    forecast.record.request = to_json(request);
    forecast.record.state = name_of(v1::Forecast::queued);
    forecast.run = std::move(run);
    return forecast;
}

ForecastService::ForecastService(const dictionary::Dictionary& dictionary, std::filesystem::path file, Keep keep)
    : dictionary_(dictionary), file_(std::move(file)), keep_(std::move(keep)), thread_([this] { work(); }) {}

ForecastService::~ForecastService() {
    {
        const std::scoped_lock lock{mutex_};
        over_ = true;
        stop_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

Result<void> ForecastService::reserve(bool truth) {
    const std::scoped_lock lock{mutex_};
    const auto waiting = static_cast<std::size_t>(
        std::ranges::count_if(waiting_, [&](const ReadForecast& each) { return each.record.truth == truth; }));
    if (waiting + reserved_[truth ? 1 : 0] >= waiting_max)
        return Error{fmt::format("{} forecasts wait already: cancel one, or wait until one is ready", waiting_max)};
    ++reserved_[truth ? 1 : 0];
    return {};
}

void ForecastService::fill(bool truth, std::optional<ReadForecast> forecast) {
    const std::scoped_lock lock{mutex_};
    --reserved_[truth ? 1 : 0];
    if (!forecast) return;
    waiting_.push_back(std::move(*forecast));
    changed_.notify_all();
}

bool ForecastService::cancel(archive::RunId run, std::uint64_t number) {
    std::optional<archive::ForecastRecord> removed;
    {
        const std::scoped_lock lock{mutex_};
        if (flying_ && is(*flying_, run, number)) {
            cancelled_ = true;
            stop_ = true;
            return true;
        }
        const auto found =
            std::ranges::find_if(waiting_, [&](const ReadForecast& each) { return is(each.record, run, number); });
        if (found == waiting_.end()) return false;
        removed = std::move(found->record);
        removed->state = name_of(v1::Forecast::cancelled);
        removed->ended = wall_clock_text();
        const std::scoped_lock ended_lock{ended_->mutex};
        ended_->all.push_back({std::move(*removed), false});
        waiting_.erase(found);
    }
    keep_ended();
    return true;
}

v1::Forecast ForecastService::now(const archive::ForecastRecord& stored) const {
    const std::scoped_lock lock{mutex_};
    archive::ForecastRecord record = stored;
    {
        const std::scoped_lock ended_lock{ended_->mutex};
        for (const auto& each : ended_->all)
            if (is(each.record, stored.run, stored.number)) record = each.record;
    }
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
        const auto waits = [&](const ReadForecast& each) { return is(each.record, record.run, record.number); };
        if (flying_ && is(*flying_, record.run, record.number)) {
            state = v1::Forecast::flying;
            told.set_done(progress_.done);
            told.set_of(progress_.of);
            told.set_without(progress_.without);
            told.set_within_without(progress_.within_without);
            told.set_with(progress_.with);
            told.set_within_with(progress_.within_with);
        } else if (reserved_ == std::array<std::size_t, 2>{} && std::ranges::none_of(waiting_, waits)) {
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
        keep_ended();
        {
            std::unique_lock lock{mutex_};
            changed_.wait_for(lock, keep_again, [this] { return over_ || !waiting_.empty(); });
            if (over_) return;
            if (waiting_.empty()) continue;
            next = std::move(waiting_.front());
            waiting_.pop_front();
            flying_ = next.record;
            progress_ = {};
            stop_ = cancelled_ = false;
        }
        fly(next);
        const std::scoped_lock lock{mutex_};
        if (cancelled_) {
            next.record.state = name_of(v1::Forecast::cancelled);
            next.record.reason.clear();
            next.record.result.clear();
        }
        const bool abandoned = over_ && next.record.state != name_of(v1::Forecast::ready);
        if (!abandoned) end(std::move(next.record));
        flying_.reset();
    }
}

void ForecastService::end(archive::ForecastRecord record) {
    const std::scoped_lock lock{ended_->mutex};
    ended_->all.push_back({std::move(record), false});
}

void ForecastService::keep_ended() {
    std::vector<archive::ForecastRecord> records;
    {
        const std::scoped_lock lock{ended_->mutex};
        for (auto& each : ended_->all)
            if (!std::exchange(each.on_its_way, true)) records.push_back(each.record);
    }
    for (const auto& record : records) {
        const auto settle = [ended = ended_, run = record.run, number = record.number](bool durable) {
            const std::scoped_lock lock{ended->mutex};
            const auto found =
                std::ranges::find_if(ended->all, [&](const auto& each) { return is(each.record, run, number); });
            if (found == ended->all.end()) return;
            if (durable)
                ended->all.erase(found);
            else
                found->on_its_way = false;
        };
        if (!keep_(record, settle)) settle(false);
    }
}

std::string ForecastService::fly_to(ReadForecast& forecast, Rehearsal& rehearsal, HeardFlight& heard) {
    auto reader = archive::Reader::open(file_, dictionary_);
    if (!reader) return reader.error().message;
    StoredPackets stored{std::move(*reader), forecast.run.run, forecast.goes_on};
    const FlyAgain how{forecast.cycle, forecast.now, [this] { return stop_.load(); },
                       [&](const telemetry::Received& received) {
                           heard.hear(received);
                           return stored.look(received);
                       }};
    const auto there = fly_again(rehearsal, forecast.run, how);
    return there ? std::string{} : there.error().message;
}

void ForecastService::fly(ReadForecast& forecast) {
    const auto& run = forecast.run;
    auto& record = forecast.record;
    const auto flown = [&]() -> Result<FlownForecast> {
        try {
            std::optional<Rehearsal> rehearsal{std::in_place, forecast.scenario,
                                               run.seed,      run.case_number,
                                               dictionary_,   std::shared_ptr<flight::CycleRunner>{},
                                               run.clock};
            HeardFlight heard{dictionary_};
            if (const auto why = fly_to(forecast, *rehearsal, heard); !why.empty()) return Error{why};
            const auto tell = [this](const ForecastProgress& progress) {
                const std::scoped_lock lock{mutex_};
                progress_ = progress;
            };
            if (record.truth)
                return forecast_from_truth(rehearsal->flight(), forecast.scenario, dictionary_, forecast.assumption,
                                           forecast.order, stop_, tell);
            const auto solution = rehearsal->landing().solution();
            rehearsal.reset();  // from here on nothing knows the truth
            const auto ground = fly_by_ground(forecast.scenario, solution, run, heard, {forecast.cycle, forecast.now},
                                              dictionary_, [this] { return stop_.load(); });
            if (!ground) return ground.error();
            return forecast_by_ground(*ground, forecast.scenario, dictionary_, forecast.assumption, forecast.order,
                                      stop_, tell);
        } catch (const CheckFailed& bug) {
            return Error{text_of_bug(bug)};
        } catch (const std::exception& error) {
            return Error{std::string{"the simulation ended: "} + error.what()};
        }
    }();
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
