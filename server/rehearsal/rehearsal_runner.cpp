// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal_runner.hpp"

#include "commands/shares.hpp"
#include "commands/timeline_change.hpp"
#include "common/entry_time.hpp"
#include "server/archive/items.hpp"
#include "server/archive/kept_request.hpp"
#include "server/base/wall_clock.hpp"
#include "server/instruction/plan_reader.hpp"
#include "server/rehearsal/command_messages.hpp"
#include "server/rehearsal/kept_requests.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tuple>

namespace aeolis::server {

using commands::may_take;

namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

constexpr milliseconds delivery_interval{5};   // half of a commit interval: a committed item is at most 15 ms old
constexpr std::size_t delivery_entries = 256;  // or this many, when it flies fast
constexpr milliseconds clocks_interval{100};   // ten times a second
constexpr milliseconds state_interval{1000};
constexpr milliseconds links_interval{1000};
constexpr milliseconds shortest_wait{1};            // shorter waits cost more than they pace
constexpr double behind_s_max = 0.25;               // behind by more, the pace is not attained: do not rush to catch up
constexpr std::uint64_t cycles_between_looks = 64;  // cycles flown again before its pace counts

constexpr const char* not_stored_yet = "taken, but not in the archive yet, which is lost if the server ends now: ";
constexpr const char* over_reason = "the run is over: nothing listens on board";

/// Of orders that set one thing, the last of a kind counts.
bool last_counts(const RunOrder& order) {
    return std::holds_alternative<PauseRun>(order) || std::holds_alternative<PaceRun>(order) ||
           std::holds_alternative<JumpRun>(order) || std::holds_alternative<StopRun>(order);
}

/// Whether a fork repeats a request of its parent; at the instant itself its plan, and a fork of the parent, whose seed
/// is its by then.
bool comes_before(const archive::ForkPoint& fork, const archive::RequestRecord& request) {
    if (request.cycle != fork.cycle) return request.cycle < fork.cycle;
    return is_fork(request) || archive::kept_request(request.request).has_plan();
}

std::string jumping_text(double to_e_s) {
    return fmt::format("the rehearsal jumps to {}: send it when it holds there", from_entry_text(to_e_s));
}

/// The time on Earth at a cycle to come.
Ert time_of_cycle(const Rehearsal& rehearsal, std::uint64_t cycle) {
    const double from_now_s = static_cast<double>(cycle - rehearsal.cycles()) * seconds_per_tick;
    return Ert{rehearsal.landing().ert_now().microseconds + std::llround(from_now_s * 1.0e6)};
}

}  // namespace

void SendCommands::refuse(const std::string& reason) const {
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
                                 Callbacks callbacks, std::optional<PlannedInjects> plan)
    : scenario_(std::move(scenario)), seed_(seed), dictionary_(dictionary), pipeline_(pipeline),
      callbacks_(std::move(callbacks)), plan_(std::move(plan)) {
    pace_ = std::clamp(pace, 0.0, pace_max);
    scenario_.radio.tones_from_samples = from_samples(scenario_.radio, pace_);
    const bool accompanied = pace_ > 0.0 && pace_ <= companion_pace_max;
    scenario_.ground_flight = callbacks_.companion && scenario_.ground_flight.value_or(accompanied);
    thread_ = std::thread{[this] { run(); }};
}

RehearsalRunner::RehearsalRunner(simulation::Scenario scenario, Again again, double pace,
                                 const dictionary::Dictionary& dictionary, PipelineThread& pipeline,
                                 Callbacks callbacks)
    : scenario_(std::move(scenario)), seed_(again.run.seed), again_(std::move(again)), dictionary_(dictionary),
      pipeline_(pipeline), callbacks_(std::move(callbacks)) {
    pace_ = std::clamp(pace, 0.0, pace_max);
    thread_ = std::thread{[this] { run(); }};
}

RehearsalRunner::~RehearsalRunner() {
    static_cast<void>(order(LeaveRun{}));
    thread_.join();
}

Result<void> RehearsalRunner::order(RunOrder order) {
    const auto refusal = [&]() -> std::string {
        const std::scoped_lock lock{mutex_};
        if (auto refused = refusal_of(order); !refused.empty()) return refused;
        if (const auto* intervene = std::get_if<InterveneRun>(&order))
            ++(intervene->intervention.has_fault() ? faults_taken_ : notes_taken_);
        else if (last_counts(order))
            std::erase_if(orders_, [&](const RunOrder& before) { return before.index() == order.index(); });
        stop_ = stop_ || std::holds_alternative<StopRun>(order) || std::holds_alternative<LeaveRun>(order);
        orders_.push_back(std::move(order));
        changed_.notify_one();
        return {};
    }();
    if (refusal.empty()) return {};
    const auto* commands = std::get_if<SendCommands>(&order);
    if (commands == nullptr) return Error{refusal};
    commands->refuse(refusal);
    return {};
}

std::string RehearsalRunner::refusal_of(const RunOrder& order) const {
    if (const auto* jump = std::get_if<JumpRun>(&order)) {
        if (over_ || stop_) return over_reason;
        if (!(jump->to_e_s > now_e_s_)) return fmt::format("jump: {} has passed", from_entry_text(jump->to_e_s));
        return {};
    }
    if (const auto* commands = std::get_if<SendCommands>(&order)) {
        if (over_ || stop_) return over_reason;
        if (const auto to_e_s = jump_under_way(); to_e_s && !commands->only_check && !knows_all(commands->requests))
            return jumping_text(*to_e_s);
        const auto own = std::ranges::count_if(orders_, [&](const RunOrder& each) {
            const auto* other = std::get_if<SendCommands>(&each);
            return other != nullptr && other->asker() == commands->asker();
        });
        const auto taken = commands_waiting();
        return may_take(static_cast<std::size_t>(own), taken, requests_max)
                   ? ""
                   : fmt::format("{} commands wait already, {} of them yours", taken, own);
    }
    const auto* intervene = std::get_if<InterveneRun>(&order);
    if (intervene == nullptr) return {};
    const auto& intervention = intervene->intervention;
    if (intervention.has_fault())
        if (const auto fault = fault_from_message(intervention.fault(), scenario_); !fault)
            return fault.error().message;
    if (over_ || stop_) return over_reason;
    if (!intervention.inject().empty()) {
        if (!conductor_) return fmt::format("plan: the run has none, and so no inject '{}'", intervention.inject());
        const auto waiting = conductor_->waiting(intervention.inject());
        return waiting ? "" : waiting.error().message;
    }
    if (intervention.has_fault() && faults_taken_ == faults_max)
        return fmt::format("{} faults have been injected into this run: no more", faults_max);
    if (intervention.has_note() && notes_taken_ == notes_max)
        return fmt::format("{} notes have been written about this run: no more", notes_max);
    return {};
}

std::optional<double> RehearsalRunner::jump_under_way() const {
    for (const auto& order : orders_)
        if (const auto* jump = std::get_if<JumpRun>(&order)) return jump->to_e_s;
    const double to_e_s = jumps_to_e_s_;
    return to_e_s == no_jump ? std::nullopt : std::optional{to_e_s};
}

bool RehearsalRunner::knows_all(const std::vector<v1::CommandRequest>& requests) const {
    return std::ranges::all_of(requests, [this](const auto& request) { return client_ids_.knows(request); });
}

std::size_t RehearsalRunner::commands_waiting() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        orders_, [](const RunOrder& order) { return std::holds_alternative<SendCommands>(order); }));
}

bool RehearsalRunner::over() const {
    const std::scoped_lock lock{mutex_};
    return over_;
}

std::size_t RehearsalRunner::waiting() const {
    const std::scoped_lock lock{mutex_};
    return commands_waiting();
}

std::optional<std::string> RehearsalRunner::name_of_command(std::uint64_t number) const {
    const std::scoped_lock lock{mutex_};
    const auto found = names_.find(number);
    return found == names_.end() ? std::nullopt : std::optional{found->second};
}

std::vector<v1::CommandRequest> RehearsalRunner::unknown(const std::vector<v1::CommandRequest>& requests) const {
    std::vector<v1::CommandRequest> unknown;
    const std::scoped_lock lock{mutex_};
    std::ranges::copy_if(requests, std::back_inserter(unknown),
                         [this](const auto& request) { return !client_ids_.knows(request); });
    return unknown;
}

std::vector<std::optional<v1::CommandReply>> RehearsalRunner::repeated(const SendCommands& order) const {
    std::vector<std::optional<v1::CommandReply>> replies;
    replies.reserve(order.requests.size());
    const std::scoped_lock lock{mutex_};
    for (const auto& request : order.requests) replies.push_back(client_ids_.reply_to(request));
    return replies;
}

void RehearsalRunner::run() {
    Rehearsal rehearsal{scenario_,   seed_, again_ ? again_->run.case_number : 0,
                        dictionary_, {},    again_ ? std::optional{again_->run.clock} : std::nullopt};
    now_e_s_ = rehearsal.landing().sclk() - scenario_.entry_sclk;
    start_ = rehearsal.run_start(pace_);
    if (callbacks_.companion) companion_ = callbacks_.companion(rehearsal);
    if (again_) start_.forked_from = again_->fork ? again_->fork : again_->run.forked_from;
    auto begun = follow_plan(rehearsal);
    if (begun) begun = begin(rehearsal);
    if (begun) {
        callbacks_.on_begun(state(rehearsal));
        if (companion_) companion_->go_live();
        fly(rehearsal);
    } else {
        callbacks_.on_begun(begun.error());
    }
    companion_.reset();  // here: what it has on other processors takes a moment to stop
    std::vector<RunOrder> late;
    {
        const std::scoped_lock lock{mutex_};
        over_ = true;
        late.swap(orders_);
    }
    for (const auto& order : late)
        if (const auto* commands = std::get_if<SendCommands>(&order)) commands->refuse(over_reason);
    if (finished_) tell(rehearsal, Clock::now(), true);  // only now: who hears of the end may begin another rehearsal
}

Result<void> RehearsalRunner::begin(Rehearsal& rehearsal) {
    if (again_) return again_->fork ? fork(rehearsal) : catch_up(rehearsal);
    const auto run = pipeline_.begin(start_);
    if (!run) return run.error();
    run_id_ = *run;
    spdlog::info("run {} begins: {} seed {} pace {}", run_id_.value, scenario_.name, seed_, pace_);
    if (plan_) {
        v1::KeptRequest kept;
        *kept.mutable_plan() = plan_->given;
        keep(rehearsal, kept);
    }
    return {};
}

Result<void> RehearsalRunner::follow_plan(const Rehearsal& rehearsal) {
    auto plan = plan_ ? std::optional{plan_->plan} : std::nullopt;
    if (again_)
        for (const auto& record : again_->run.requests) {
            if (again_->fork && !comes_before(*again_->fork, record)) continue;
            const auto kept = archive::kept_request(record.request);
            if (kept.has_intervention()) settled_in_archive_.insert(kept.intervention().inject());
            if (!kept.has_plan()) continue;
            auto read = instruction::read_plan(kept.plan(), dictionary_);
            if (!read.plan) {  // the findings are for instructors
                spdlog::error("run {}: {}", again_->run.run.value, read.findings_text());
                return Error{fmt::format("run {} needs another version: the log says why", again_->run.run.value)};
            }
            plan = std::move(*read.plan);
        }
    if (!plan) return {};
    const Scet entry = rehearsal.landing().correlation().scet_of(scenario_.entry_sclk);
    const std::scoped_lock lock{mutex_};
    conductor_.emplace(std::move(*plan), dictionary_,
                       procedures::EntryPrediction{entry, rehearsal.landing().light_time_s()});
    return {};
}

void RehearsalRunner::conduct(Rehearsal& rehearsal) {
    std::vector<const instruction::Inject*> due;
    {
        const std::scoped_lock lock{mutex_};
        if (!conductor_) return;
        due = conductor_->pass(rehearsal.landing().report().recorded, rehearsal.landing().ert_now());
    }
    for (const auto* inject : due) {
        if (settled_in_archive_.contains(inject->id)) continue;  // flown again: it comes with the run's own requests
        InterveneRun order;
        order.intervention.set_inject(inject->id);
        *order.intervention.mutable_fault() = inject->fault;
        carry_out(rehearsal, order);
    }
}

bool RehearsalRunner::stop_wanted() const {
    const std::scoped_lock lock{mutex_};
    return stop_;
}

Result<void> RehearsalRunner::repeat_due(Rehearsal& rehearsal, std::size_t& next) {
    const auto& requests = again_->run.requests;
    for (; next < requests.size() && requests[next].cycle == rehearsal.cycles(); ++next) {
        if (!repeat(rehearsal, requests[next].request))
            return Error{fmt::format("what was taken at cycle {} is refused now", requests[next].cycle)};
        take_stages(rehearsal);
    }
    return {};
}

Result<void> RehearsalRunner::catch_up(Rehearsal& rehearsal) {
    auto& cut = again_->run;
    run_id_ = cut.run;
    start_.started = cut.started;
    spdlog::info("run {} is flown again up to item {}", run_id_.value, cut.last_seq);
    if (auto resumed = pipeline_.resume(cut, start_); !resumed) return resumed;
    const auto given_up = [&](const std::string& why) {
        pipeline_.abandon();
        return Error{fmt::format("run {} cannot be continued: {}", run_id_.value, why)};
    };
    for (std::size_t next = 0;;) {
        if (stop_wanted()) return given_up("it was stopped");
        if (const auto repeated = repeat_due(rehearsal, next); !repeated) return given_up(repeated.error().message);
        if (rehearsal.cycles() % cycles_between_looks == 0) {
            if (!deliver(rehearsal, Clock::now())) return given_up("the archive gave up");
            const auto caught_up = pipeline_.caught_up();
            if (!caught_up) return given_up(caught_up.error().message);
            if (*caught_up && next == cut.requests.size()) break;
            if (rehearsal.finished()) return given_up(fmt::format("flown again it ends before item {}", cut.last_seq));
        }
        step(rehearsal);
    }
    if (end_jump(rehearsal)) paused_ = true;  // it was cut off within it: the next act is the instructor's
    spdlog::info("run {} goes on from item {}, at E{:+.1f} s", run_id_.value, cut.last_seq, rehearsal.clocks().e_s());
    return {};
}

Result<void> RehearsalRunner::fork(Rehearsal& rehearsal) {
    auto& parent = again_->run;
    const auto& at = *again_->fork;
    std::erase_if(parent.requests, [&](const archive::RequestRecord& each) { return !comes_before(at, each); });
    const auto run = pipeline_.begin(start_, parent.run, time_of_cycle(rehearsal, at.cycle));
    if (!run) return run.error();
    run_id_ = *run;
    spdlog::info("run {} begins as run {}, flown again up to E{:+.1f} s", run_id_.value, parent.run.value, at.e_s);
    const auto given_up = [&](const std::string& why) {
        const auto reason = fmt::format("it could not be forked from run {}: {}", parent.run.value, why);
        deliver(rehearsal, Clock::now());
        static_cast<void>(pipeline_.finish({archive::Outcome::stopped, reason, "", wall_clock_text()}));
        return Error{fmt::format("run {}: {}", run_id_.value, reason)};
    };
    // All of them first: a fork that is cut off here is continued with them, and so comes to the fork.
    for (const auto& request : parent.requests) delivery_.entries.emplace_back(request);
    v1::KeptRequest marker;
    *marker.mutable_fork() = archive::to_reply(at);
    delivery_.entries.emplace_back(archive::RequestRecord{at.cycle, archive::kept_text(marker)});
    std::size_t next = 0;
    while (rehearsal.cycles() < at.cycle) {
        if (stop_wanted()) return given_up("it was stopped");
        if (const auto repeated = repeat_due(rehearsal, next); !repeated) return given_up(repeated.error().message);
        if (delivery_.entries.size() >= delivery_entries && !deliver(rehearsal, Clock::now()))
            return given_up("the archive gave up");
        if (pipeline_.differs()) break;
        if (rehearsal.finished())
            return given_up(fmt::format("the run ends before, at E{:+.1f} s: {}", rehearsal.clocks().e_s(),
                                        rehearsal.outcome_reason()));
        step(rehearsal);
    }
    if (rehearsal.cycles() == at.cycle)
        if (const auto repeated = repeat_due(rehearsal, next); !repeated) return given_up(repeated.error().message);
    if (!deliver(rehearsal, Clock::now())) return given_up("the archive gave up");
    const auto last = pipeline_.forked();
    if (!last) return given_up(last.error().message);
    parent.last_seq = *last;
    if (at.seed != 0)
        if (const auto redrawn = rehearsal.redraw(at.seed); !redrawn) return given_up(redrawn.error().message);
    end_jump(rehearsal);
    paused_ = again_->paused;
    spdlog::info("run {} goes on by itself from E{:+.1f} s", run_id_.value, rehearsal.clocks().e_s());
    return {};
}

void RehearsalRunner::count_pace_from(const Rehearsal& rehearsal, Clock::time_point now) {
    pace_since_ = now;
    pace_since_cycle_ = rehearsal.cycles();
}

RehearsalRunner::Clock::time_point RehearsalRunner::next_cycle_due(const Rehearsal& rehearsal,
                                                                   Clock::time_point now) const {
    if (paused_) return now + clocks_interval;
    if (pace_ == 0.0 || jumps_to_e_s_ != no_jump) return now;
    const double flown_s = static_cast<double>(rehearsal.cycles() - pace_since_cycle_) * seconds_per_tick / pace_;
    return pace_since_ + std::chrono::duration_cast<Clock::duration>(duration<double>{flown_s});
}

std::vector<RunOrder> RehearsalRunner::take_orders(std::optional<Clock::time_point> due) {
    std::unique_lock lock{mutex_};
    if (due) changed_.wait_until(lock, *due, [&] { return !orders_.empty(); });
    return std::exchange(orders_, {});
}

void RehearsalRunner::fly(Rehearsal& rehearsal) {
    count_pace_from(rehearsal, Clock::now());
    state_told_ = clocks_told_ = delivered_ = pace_since_;
    while (!rehearsal.finished() && !stopped_ && !left_ && !archive_gave_up_) {
        auto now = Clock::now();
        const auto due = next_cycle_due(rehearsal, now);
        const bool wait = due - now >= shortest_wait;
        if (wait) archive_gave_up_ = !deliver(rehearsal, now);
        tell(rehearsal, now, false);
        auto orders = take_orders(wait ? std::optional{due} : std::nullopt);
        now = Clock::now();
        if (!orders.empty()) {
            if (carry_out(rehearsal, orders)) {
                count_pace_from(rehearsal, now);
                tell(rehearsal, now, true);
            }
            continue;
        }
        if (paused_ || now - due > duration<double>{behind_s_max}) count_pace_from(rehearsal, now);
        if (paused_) continue;
        step(rehearsal);
        if (const double to_e_s = jumps_to_e_s_; to_e_s != no_jump && now_e_s_ >= to_e_s) {
            end_jump(rehearsal);
            paused_ = true;
            tell(rehearsal, Clock::now(), true);
        }
        if (now - delivered_ >= delivery_interval || delivery_.entries.size() >= delivery_entries)
            archive_gave_up_ = archive_gave_up_ || !deliver(rehearsal, now);
    }
    if (left_ && !stopped_ && !rehearsal.finished()) {
        leave(rehearsal);
    } else {
        end_jump(rehearsal);
        finish(rehearsal);
    }
}

void RehearsalRunner::leave(const Rehearsal& rehearsal) {
    deliver(rehearsal, Clock::now());
    pipeline_.leave();
    spdlog::info("run {} is left at E{:+.1f} s: it can be continued", run_id_.value, rehearsal.clocks().e_s());
}

void RehearsalRunner::finish(Rehearsal& rehearsal) {
    digest_ = rehearsal.digest();
    deliver(rehearsal, Clock::now());
    finished_ = true;
    const std::string reason = rehearsal.finished() ? rehearsal.outcome_reason() : "stopped before its end";
    const auto finished = pipeline_.finish({outcome(rehearsal), reason, digest_, wall_clock_text()});
    if (!finished) spdlog::error("run {}: its end could not be stored: {}", run_id_.value, finished.error().message);
    for (const auto& refusal : rehearsal.script_refusals())
        spdlog::warn("run {}: scripted command refused: {}", run_id_.value, refusal);
    spdlog::info("run {} ends: {} {}", run_id_.value, name_of(outcome(rehearsal)), reason);
}

std::vector<v1::CommandReply> RehearsalRunner::look_at(Rehearsal& rehearsal, const SendCommands& order) {
    if (!order.only_check && order.requests.size() == 1) return {};  // it is checked once, when taken
    auto replies = rehearsal.look(order.requests, order.browser);
    if (!order.only_check && std::ranges::all_of(replies, &v1::CommandReply::accepted)) replies.clear();
    return replies;
}

bool RehearsalRunner::carry_out(Rehearsal& rehearsal, const std::vector<RunOrder>& orders) {
    const auto set = [this] { return std::tuple{paused_, pace_, jumps_to_e_s_.load()}; };
    const auto before = set();
    for (const auto& order : orders) std::visit([&](const auto& each) { carry_out(rehearsal, each); }, order);
    if (!delivery_.answers.empty()) archive_gave_up_ = !deliver(rehearsal, Clock::now());
    return before != set();
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, const PauseRun& order) {
    paused_ = order.paused;
    if (paused_) end_jump(rehearsal);
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, const JumpRun& order) {
    end_jump(rehearsal);
    paused_ = !(order.to_e_s > now_e_s_);  // it has passed since it was ordered: hold here
    if (paused_) return;
    jumps_from_e_s_ = now_e_s_;
    jumps_to_e_s_ = order.to_e_s;
    keep_jump(rehearsal, order.to_e_s, true);
    spdlog::info("run {} jumps from {} to {}", run_id_.value, from_entry_text(now_e_s_), from_entry_text(order.to_e_s));
}

bool RehearsalRunner::end_jump(const Rehearsal& rehearsal) {
    if (jumps_to_e_s_.exchange(no_jump) == no_jump) return false;
    keep_jump(rehearsal, now_e_s_, false);
    return true;
}

void RehearsalRunner::keep_jump(const Rehearsal& rehearsal, double to_e_s, bool begins) {
    v1::KeptRequest kept;
    kept.mutable_jump()->set_from_e_s(jumps_from_e_s_);
    kept.mutable_jump()->set_to_e_s(to_e_s);
    kept.mutable_jump()->set_begins(begins);
    keep(rehearsal, kept);
}

void RehearsalRunner::carry_out(Rehearsal& /*rehearsal*/, const PaceRun& order) {
    pace_ = std::clamp(order.pace, 0.0, pace_max);
}

void RehearsalRunner::carry_out(Rehearsal& /*rehearsal*/, const StopRun& /*order*/) {
    stopped_ = true;
}

void RehearsalRunner::carry_out(Rehearsal& /*rehearsal*/, const LeaveRun& /*order*/) {
    left_ = true;
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, const InterveneRun& order) {
    auto intervention = order.intervention;
    if (const bool by_hand = !intervention.has_fault(); by_hand && !intervention.inject().empty()) {
        const std::scoped_lock lock{mutex_};
        const auto waiting = conductor_->waiting(intervention.inject());
        if (!waiting) return;  // it became due meanwhile
        if (!intervention.skipped()) *intervention.mutable_fault() = (*waiting)->fault;
        conductor_->settle(intervention.inject());
    }
    if (intervention.has_fault()) {
        if (const auto injected = rehearsal.inject(intervention.fault()); !injected) {  // already checked
            spdlog::error("run {}: fault not injected: {}", run_id_.value, injected.error().message);
            return;
        }
        spdlog::info("run {}: fault injected: {}", run_id_.value, intervention.fault().ShortDebugString());
    }
    v1::KeptRequest kept;
    *kept.mutable_intervention() = intervention;
    keep(rehearsal, kept);
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, const SendCommands& order) {
    auto known = repeated(order);
    for (const auto& reply : known)
        if (reply && !reply->accepted()) return order.refuse(reply->reason());
    SendCommands fresh{{}, order.only_check, {}, order.browser, order.director};
    for (std::size_t i = 0; i < known.size(); ++i)
        if (!known[i]) fresh.requests.push_back(order.requests[i]);
    auto looked = fresh.requests.empty() ? std::vector<v1::CommandReply>{} : look_at(rehearsal, fresh);
    const bool send = looked.empty() && !order.only_check;
    if (send)
        for (const auto& request : fresh.requests) looked.push_back(submit(rehearsal, request, order));
    std::vector<v1::CommandReply> replies;
    replies.reserve(known.size());
    auto next = looked.begin();
    for (auto& reply : known) replies.push_back(reply ? std::move(*reply) : std::move(*next++));
    if (!send || std::ranges::none_of(replies, &v1::CommandReply::accepted)) return order.replies(std::move(replies));
    delivery_.answers.push_back([give = order.replies, given = std::move(replies)](const std::string& fault) mutable {
        for (auto& reply : given)
            if (reply.accepted() && !fault.empty()) reply.set_reason(not_stored_yet + fault);
        give(std::move(given));
    });
}

v1::CommandReply RehearsalRunner::submit(Rehearsal& rehearsal, const v1::CommandRequest& request,
                                         const SendCommands& order) {
    auto reply = rehearsal.submit(request, order.browser, order.director);
    const auto what =
        request.action().empty() ? request.command() : fmt::format("{} of {}", request.action(), request.number());
    spdlog::info("run {}: command {} {}", run_id_.value, what,
                 reply.accepted() ? fmt::format("taken as number {}", reply.command()) : "refused: " + reply.reason());
    if (!reply.accepted()) return reply;
    v1::KeptRequest kept;
    *kept.mutable_command() = request;
    kept.set_browser(order.browser);
    kept.set_director(order.director);
    keep(rehearsal, kept);
    {
        const std::scoped_lock lock{mutex_};
        client_ids_.accepted(request, reply.command());
    }
    take_stages(rehearsal);
    return reply;
}

void RehearsalRunner::carry_out(Rehearsal& rehearsal, const commands::TimelineVerdict& verdict) {
    // Refused when the command does not wait for it any more, or another analysis is on its way: nobody asked, so
    // nobody is told.
    if (!rehearsal.judge(verdict)) return;
    spdlog::info("run {}: the timeline with command {} {}: {}", run_id_.value, verdict.command,
                 verdict.refuted ? "is refuted" : "holds", verdict.analysis);
    v1::KeptRequest kept;
    *kept.mutable_verdict() = message_of(verdict);
    keep(rehearsal, kept);
    take_stages(rehearsal);
}

void RehearsalRunner::keep(const Rehearsal& rehearsal, const v1::KeptRequest& request) {
    delivery_.entries.emplace_back(archive::RequestRecord{rehearsal.cycles(), archive::kept_text(request)});
    tell_companion(rehearsal, request);
}

void RehearsalRunner::tell_companion(const Rehearsal& rehearsal, const v1::KeptRequest& request) {
    const bool hidden = request.has_intervention() || request.has_plan();
    if (companion_ && !hidden) companion_->take(rehearsal.cycles(), request);
}

bool RehearsalRunner::repeat(Rehearsal& rehearsal, const std::string& request) {
    const auto kept = archive::kept_request(request);
    tell_companion(rehearsal, kept);
    if (kept.has_jump()) {
        jumps_from_e_s_ = kept.jump().from_e_s();
        jumps_to_e_s_ = kept.jump().begins() ? kept.jump().to_e_s() : no_jump;
    }
    if (kept.has_intervention()) {
        const std::scoped_lock lock{mutex_};
        if (conductor_) conductor_->settle(kept.intervention().inject());
    }
    return server::repeat(rehearsal, kept, [&](const v1::CommandReply& reply) {
        const std::scoped_lock lock{mutex_};
        client_ids_.accepted(kept.command(), reply.command());
    });
}

void RehearsalRunner::step(Rehearsal& rehearsal) {
    auto& received = rehearsal.step();
    if (companion_) accompany(received, rehearsal);
    delivery_.add(std::move(received));
    delivery_.pass(rehearsal.cycles(), rehearsal.landing().ert_now());
    take_stages(rehearsal);
    conduct(rehearsal);
    now_e_s_ = rehearsal.landing().sclk() - scenario_.entry_sclk;
}

void RehearsalRunner::accompany(const telemetry::Received& received, const Rehearsal& rehearsal) {
    auto made = companion_->hear(received, rehearsal.landing().ert_now());
    for (auto& packet : made.packets) delivery_.entries.emplace_back(std::move(packet));
    if (made.request) keep(rehearsal, *made.request);
}

void RehearsalRunner::take_stages(Rehearsal& rehearsal) {
    for (auto& stage : rehearsal.take_stages()) {
        const bool ended = stage.status == commands::Status::failed;
        timeline_moved_ = timeline_moved_ || (ended && commands::changes_offsets(stage.name));
        {
            const std::scoped_lock lock{mutex_};
            if (stage.stage == commands::Stage::queued) names_.emplace(stage.command, stage.name);
            client_ids_.note(stage);
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

archive::Outcome RehearsalRunner::outcome(const Rehearsal& rehearsal) const {
    const auto outcome = rehearsal.outcome();
    return finished_ && outcome == archive::Outcome::running ? archive::Outcome::stopped : outcome;
}

v1::RunState RehearsalRunner::state(const Rehearsal& rehearsal) const {
    v1::RunState state;
    state.set_run(run_id_.value);
    if (again_) state.set_last_seq(again_->run.last_seq);  // until the stream gives newer numbers
    if (start_.forked_from) *state.mutable_forked_from() = archive::to_reply(*start_.forked_from);
    state.set_scenario(start_.scenario);
    state.set_title(start_.title);
    state.set_venue(start_.venue);
    state.set_seed(seed_);
    state.set_state(finished_ ? v1::RunState::finished : paused_ ? v1::RunState::paused : v1::RunState::running);
    state.set_outcome(static_cast<v1::Landing::Outcome>(outcome(rehearsal)));
    state.set_pace(pace_);
    state.set_attained_pace(attained_pace_);
    if (const double to_e_s = jumps_to_e_s_; to_e_s != no_jump && !finished_) state.set_jumps_to_e_s(to_e_s);
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
