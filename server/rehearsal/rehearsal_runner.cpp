// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal_runner.hpp"

#include "commands/timeline_change.hpp"
#include "server/archive/items.hpp"
#include "server/archive/kept_request.hpp"
#include "server/base/wall_clock.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

constexpr milliseconds delivery_interval{5};   // half a commit's: a commit then holds what is 15 ms old at most
constexpr std::size_t delivery_entries = 256;  // or so many, when it goes fast
constexpr milliseconds clocks_interval{100};   // ten times a second: brief of the stream
constexpr milliseconds state_interval{1000};
constexpr milliseconds links_interval{1000};
constexpr milliseconds shortest_wait{1};  // shorter ones cost more than they pace
constexpr double behind_s_max = 0.25;     // later than that the pace is not attained; do not rush to catch up
constexpr std::uint64_t cycles_between_looks =
    64;  // while flying again: as far as a run may go on before its pace counts

constexpr const char* not_stored_yet = "taken, but not in the archive yet, which is lost if the server ends now: ";
constexpr const char* over_reason = "the run is over: nothing listens on board";

}  // namespace

void RehearsalRunner::refuse_all(const std::vector<v1::CommandRequest>& requests, const std::string& reason,
                                 const Replies& replies) {
    std::vector<v1::CommandReply> refusals;
    for (const auto& request : requests) {
        auto& refusal = refusals.emplace_back();
        refusal.set_request(request.request());
        refusal.set_reason(reason);
    }
    replies(std::move(refusals));
}

RehearsalRunner::RehearsalRunner(simulation::Scenario scenario, std::uint64_t seed, double pace,
                                 const dictionary::Dictionary& dictionary, PipelineThread& pipeline,
                                 Callbacks callbacks)
    : scenario_(std::move(scenario)), seed_(seed), dictionary_(dictionary), pipeline_(pipeline),
      callbacks_(std::move(callbacks)) {
    control_.pace = pace_ = std::clamp(pace, 0.0, pace_max);
    scenario_.radio.tones_from_samples = from_samples(scenario_.radio, pace_);
    thread_ = std::thread{[this] { run(); }};
}

RehearsalRunner::RehearsalRunner(simulation::Scenario scenario, archive::CutOffRun cut, double pace,
                                 const dictionary::Dictionary& dictionary, PipelineThread& pipeline,
                                 Callbacks callbacks)
    : scenario_(std::move(scenario)), seed_(cut.seed), cut_(std::move(cut)), dictionary_(dictionary),
      pipeline_(pipeline), callbacks_(std::move(callbacks)) {
    control_.pace = pace_ = std::clamp(pace, 0.0, pace_max);
    thread_ = std::thread{[this] { run(); }};
}

RehearsalRunner::~RehearsalRunner() {
    stop();
    thread_.join();
}

void RehearsalRunner::pause(bool paused) {
    const std::scoped_lock lock{mutex_};
    control_.paused = paused;
    control_.changed = true;
    changed_.notify_one();
}

void RehearsalRunner::set_pace(double pace) {
    const std::scoped_lock lock{mutex_};
    control_.pace = std::clamp(pace, 0.0, pace_max);
    control_.changed = true;
    changed_.notify_one();
}

void RehearsalRunner::stop() {
    const std::scoped_lock lock{mutex_};
    control_.stop = true;
    control_.changed = true;
    changed_.notify_one();
}

Result<void> RehearsalRunner::inject(v1::FaultInjection injection) {
    if (const auto fault = fault_from_message(injection, scenario_); !fault) return fault.error();
    v1::Intervention intervention;
    *intervention.mutable_fault() = std::move(injection);
    return intervene(std::move(intervention), faults_taken_, faults_max, "faults have been injected into");
}

Result<void> RehearsalRunner::note(v1::InstructorNote note) {
    v1::Intervention intervention;
    *intervention.mutable_note() = std::move(note);
    return intervene(std::move(intervention), notes_taken_, notes_max, "notes have been written about");
}

Result<void> RehearsalRunner::intervene(v1::Intervention intervention, std::size_t& taken, std::size_t most,
                                        std::string_view what) {
    const std::scoped_lock lock{mutex_};
    if (over_ || control_.stop) return Error{over_reason};
    if (taken == most) return Error{fmt::format("{} {} this run: no more", most, what)};
    ++taken;
    control_.interventions.push_back(std::move(intervention));
    control_.changed = true;
    changed_.notify_one();
    return {};
}

void RehearsalRunner::submit(v1::CommandRequest request, Reply reply) {
    const bool only_check = request.dry_run();
    std::vector<v1::CommandRequest> one;
    one.push_back(std::move(request));
    submit(std::move(one), only_check,
           [reply = std::move(reply)](std::vector<v1::CommandReply> replies) { reply(std::move(replies.front())); });
}

void RehearsalRunner::submit(std::vector<v1::CommandRequest> sequence, bool only_check, Replies replies) {
    Order order{std::move(sequence), only_check, std::move(replies)};
    std::string reason;
    {
        const std::scoped_lock lock{mutex_};
        if (over_ || control_.stop) {
            reason = over_reason;
        } else if (control_.orders.size() >= requests_max) {
            reason = fmt::format("{} commands wait already", requests_max);
        } else {
            control_.orders.push_back(std::move(order));
            control_.changed = true;
            changed_.notify_one();
            return;
        }
    }
    refuse_all(order.requests, reason, order.replies);
}

bool RehearsalRunner::over() const {
    const std::scoped_lock lock{mutex_};
    return over_;
}

std::size_t RehearsalRunner::waiting() const {
    const std::scoped_lock lock{mutex_};
    return control_.orders.size();
}

std::optional<std::string> RehearsalRunner::name_of_command(std::uint64_t number) const {
    const std::scoped_lock lock{mutex_};
    const auto found = names_.find(number);
    return found == names_.end() ? std::nullopt : std::optional{found->second};
}

void RehearsalRunner::run() {
    Rehearsal rehearsal{scenario_, seed_, 0, dictionary_, {}, cut_ ? std::optional{cut_->clock} : std::nullopt};
    start_ = rehearsal.run_start(pace_);
    if (const auto begun = begin(rehearsal)) {
        callbacks_.on_begun(state(rehearsal));
        fly(rehearsal);
    } else {
        callbacks_.on_begun(begun.error());
    }
    std::vector<Order> late;
    {
        const std::scoped_lock lock{mutex_};
        over_ = true;
        late.swap(control_.orders);
    }
    for (const auto& order : late) refuse_all(order.requests, over_reason, order.replies);
}

Result<void> RehearsalRunner::begin(Rehearsal& rehearsal) {
    if (cut_) return catch_up(rehearsal);
    const auto run = pipeline_.begin(start_);
    if (!run) return run.error();
    run_id_ = *run;
    spdlog::info("run {} begins: {} seed {} pace {}", run_id_.value, scenario_.name, seed_, pace_);
    return {};
}

bool RehearsalRunner::stop_wanted() const {
    const std::scoped_lock lock{mutex_};
    return control_.stop;
}

Result<void> RehearsalRunner::catch_up(Rehearsal& rehearsal) {
    run_id_ = cut_->run;
    start_.started = cut_->started;
    spdlog::info("run {} is flown again up to item {}", run_id_.value, cut_->last_seq);
    if (auto resumed = pipeline_.resume(*cut_, start_); !resumed) return resumed;
    const auto given_up = [&](const std::string& why) {
        pipeline_.abandon();
        return Error{fmt::format("run {} cannot be continued: {}", run_id_.value, why)};
    };
    auto request = cut_->requests.begin();
    for (;;) {
        if (stop_wanted()) return given_up("it was stopped");
        for (; request != cut_->requests.end() && request->cycle == rehearsal.cycles(); ++request) {
            if (!repeat(rehearsal, request->request))
                return given_up("what was taken at cycle " + std::to_string(request->cycle) + " is refused now");
            take_stages(rehearsal);
        }
        if (rehearsal.cycles() % cycles_between_looks == 0) {
            if (!deliver(rehearsal, Clock::now())) return given_up("the archive gave up");
            const auto caught_up = pipeline_.caught_up();
            if (!caught_up) return given_up(caught_up.error().message);
            if (*caught_up && request == cut_->requests.end()) break;
            if (rehearsal.finished())
                return given_up(fmt::format("flown again it ends before item {}", cut_->last_seq));
        }
        collect(rehearsal, rehearsal.step());
    }
    spdlog::info("run {} goes on from item {}, at E{:+.1f} s", run_id_.value, cut_->last_seq, rehearsal.clocks().e_s());
    return {};
}

void RehearsalRunner::fly(Rehearsal& rehearsal) {
    auto anchor = Clock::now();  // the pace counts from here
    auto anchor_cycles = rehearsal.cycles();
    state_told_ = clocks_told_ = delivered_ = anchor;
    while (!rehearsal.finished() && !stopped_ && !archive_gave_up_) {
        auto now = Clock::now();
        // Time when the next cycle is due; without pace it always is.
        auto due = now;
        if (pace_ > 0.0) {
            const double flown_s = static_cast<double>(rehearsal.cycles() - anchor_cycles) * seconds_per_tick / pace_;
            due = anchor + std::chrono::duration_cast<Clock::duration>(duration<double>{flown_s});
        }
        if (paused_) due = now + clocks_interval;
        const bool wait = due - now >= shortest_wait;
        if (wait) archive_gave_up_ = !deliver(rehearsal, now);
        tell(rehearsal, now, false);

        Control control;
        {
            std::unique_lock lock{mutex_};
            if (wait) changed_.wait_until(lock, due, [&] { return control_.changed; });
            control.paused = control_.paused;
            control.stop = control_.stop;
            control.pace = control_.pace;
            control.changed = std::exchange(control_.changed, false);
            control.orders.swap(control_.orders);
            control.interventions.swap(control_.interventions);
        }
        now = Clock::now();
        if (control.changed) {
            const bool different = paused_ != control.paused || pace_ != control.pace;
            paused_ = control.paused;
            pace_ = control.pace;
            stopped_ = control.stop;
            bring_about(rehearsal, control.interventions);
            carry_out(rehearsal, std::move(control.orders));
            if (different) {
                anchor = now;
                anchor_cycles = rehearsal.cycles();
                tell(rehearsal, now, true);
            }
            continue;
        }
        if (paused_) {
            anchor = now;
            anchor_cycles = rehearsal.cycles();
            continue;
        }
        if (now - due > duration<double>{behind_s_max}) {
            anchor = now;
            anchor_cycles = rehearsal.cycles();
        }
        collect(rehearsal, rehearsal.step());
        if (now - delivered_ >= delivery_interval || delivery_.entries.size() >= delivery_entries)
            archive_gave_up_ = archive_gave_up_ || !deliver(rehearsal, now);
    }
    digest_ = rehearsal.digest();
    deliver(rehearsal, Clock::now());
    finished_ = true;
    const std::string reason = rehearsal.finished() ? rehearsal.outcome_reason() : "stopped before its end";
    const auto finished = pipeline_.finish({outcome(rehearsal), reason, digest_, wall_clock_text()});
    if (!finished) spdlog::error("run {}: its end could not be stored: {}", run_id_.value, finished.error().message);
    for (const auto& refusal : rehearsal.script_refusals())
        spdlog::warn("run {}: scripted command refused: {}", run_id_.value, refusal);
    spdlog::info("run {} ends: {} {}", run_id_.value, outcome(rehearsal), reason);
    tell(rehearsal, Clock::now(), true);
}

std::vector<v1::CommandReply> RehearsalRunner::look_at(Rehearsal& rehearsal, const Order& order) {
    if (!order.only_check && order.requests.size() == 1) return {};  // the one look at it comes when it is taken
    auto replies = rehearsal.look(order.requests);
    if (!order.only_check && std::ranges::all_of(replies, &v1::CommandReply::accepted)) replies.clear();
    return replies;
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, std::vector<Order> orders) {
    for (auto& order : orders) {
        auto replies = look_at(rehearsal, order);
        if (!replies.empty()) {
            order.replies(std::move(replies));
            continue;
        }
        bool any = false;
        for (const auto& request : order.requests) {
            auto answer = rehearsal.submit(request);
            const auto what = request.action().empty() ? request.command()
                                                       : fmt::format("{} of {}", request.action(), request.number());
            spdlog::info("run {}: command {} {}", run_id_.value, what,
                         answer.accepted() ? fmt::format("taken as number {}", answer.command())
                                           : "refused: " + answer.reason());
            if (answer.accepted()) {
                any = true;
                delivery_.entries.emplace_back(archive::RequestRecord{rehearsal.cycles(), archive::kept_text(request)});
                take_stages(rehearsal);
            }
            replies.push_back(std::move(answer));
        }
        if (any)
            delivery_.answers.push_back(
                [give = std::move(order.replies), given = std::move(replies)](const std::string& fault) mutable {
                    for (auto& reply : given)
                        if (reply.accepted() && !fault.empty()) reply.set_reason(not_stored_yet + fault);
                    give(std::move(given));
                });
        else
            order.replies(std::move(replies));
    }
    if (!delivery_.answers.empty()) archive_gave_up_ = !deliver(rehearsal, Clock::now());
}

void RehearsalRunner::bring_about(Rehearsal& rehearsal, const std::vector<v1::Intervention>& interventions) {
    for (const auto& intervention : interventions) {
        if (intervention.has_fault()) {
            if (const auto injected = rehearsal.inject(intervention.fault());
                !injected) {  // inject() has looked at it already
                spdlog::error("run {}: fault not injected: {}", run_id_.value, injected.error().message);
                continue;
            }
            spdlog::info("run {}: fault injected: {}", run_id_.value, intervention.fault().ShortDebugString());
        }
        delivery_.entries.emplace_back(archive::RequestRecord{rehearsal.cycles(), archive::kept_text(intervention)});
    }
}

bool RehearsalRunner::repeat(Rehearsal& rehearsal, const std::string& request) {
    const auto kept = archive::kept_request(request);
    if (const auto* command = std::get_if<v1::CommandRequest>(&kept)) return rehearsal.submit(*command).accepted();
    const auto* intervention = std::get_if<v1::Intervention>(&kept);
    return intervention != nullptr && (!intervention->has_fault() || rehearsal.inject(intervention->fault()).ok());
}

void RehearsalRunner::collect(Rehearsal& rehearsal, const telemetry::Received& received) {
    delivery_.add(received);
    delivery_.pass(rehearsal.cycles(), rehearsal.landing().ert_now());
    take_stages(rehearsal);
}

void RehearsalRunner::take_stages(Rehearsal& rehearsal) {
    for (auto& stage : rehearsal.take_stages()) {
        const bool ended = stage.status == commands::Status::failed;
        timeline_moved_ = timeline_moved_ || (ended && commands::changes_offsets(stage.name));
        if (stage.stage == commands::Stage::queued) {
            const std::scoped_lock lock{mutex_};
            names_.emplace(stage.command, stage.name);
        }
        delivery_.entries.emplace_back(std::move(stage));
    }
}

bool RehearsalRunner::deliver(const Rehearsal& rehearsal, Clock::time_point now) {
    delivered_ = now;
    queued_ = rehearsal.gateway().queued();
    at_uplink_ = rehearsal.gateway().at_uplink();
    if (delivery_.entries.empty() && delivery_.answers.empty()) return true;
    delivery_.relay_progress = rehearsal.recording_progress();
    if (now - links_told_ >= links_interval || rehearsal.finished()) {
        links_told_ = now;
        delivery_.links = rehearsal.link_totals();
    }
    if (std::exchange(timeline_moved_, false) && callbacks_.on_timeline_moved)
        delivery_.when_durable.push_back(callbacks_.on_timeline_moved);
    return pipeline_.deliver(std::exchange(delivery_, {}));
}

void RehearsalRunner::tell(const Rehearsal& rehearsal, Clock::time_point now, bool changed) {
    if (changed || now - clocks_told_ >= clocks_interval) {
        clocks_told_ = now;
        callbacks_.on_clocks(rehearsal.clocks());
    }
    if (now - state_told_ >= state_interval) {
        const double wall_s = duration<double>{now - state_told_}.count();
        attained_pace_ = static_cast<double>(rehearsal.cycles() - cycles_told_) * seconds_per_tick / wall_s;
        cycles_told_ = rehearsal.cycles();
        state_told_ = now;
        changed = true;
    }
    if (changed) callbacks_.on_state(state(rehearsal));
}

std::string RehearsalRunner::outcome(const Rehearsal& rehearsal) const {
    const auto outcome = rehearsal.outcome();
    return finished_ && outcome == "running" ? "stopped" : outcome;
}

std::string RehearsalRunner::state_word() const {
    if (finished_) return "finished";
    return paused_ ? "paused" : "running";
}

v1::RunState RehearsalRunner::state(const Rehearsal& rehearsal) const {
    v1::RunState state;
    state.set_run(run_id_.value);
    if (cut_) state.set_last_seq(cut_->last_seq);  // until the stream says what has come since
    state.set_scenario(start_.scenario);
    state.set_title(start_.title);
    state.set_venue(start_.venue);
    state.set_seed(seed_);
    state.set_state(state_word());
    state.set_outcome(outcome(rehearsal));
    state.set_pace(pace_);
    state.set_attained_pace(attained_pace_);
    state.set_started(start_.started);
    state.set_entry_sclk(start_.entry.seconds);
    state.set_start_sclk(start_.start.seconds);
    state.set_light_time_s(start_.light_time_s);
    *state.mutable_clock() = archive::to_reply(start_.correlation);
    *state.mutable_clocks() = rehearsal.clocks();
    state.set_relay_progress(rehearsal.recording_progress());
    for (const auto& [name, value] : start_.solution) {
        auto& argument = *state.add_solution();
        argument.set_name(name);
        argument.set_value(value);
    }
    state.set_tone_model(start_.tone_model);
    state.set_digest(digest_);
    return state;
}

}  // namespace aeolis::server
