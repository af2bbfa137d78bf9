// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal_manager.hpp"

#include "commands/command_gateway.hpp"
#include "commands/shares.hpp"
#include "server/archive/run_instant.hpp"
#include "server/pipeline/annotations.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/scenario/script_check.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr const char* nobody_listens = "no run goes on: nothing listens";

/// Whether the request continues or forks a run.
bool flies_again(const v1::StartRehearsal& request) {
    return request.continue_run() != 0 || request.has_fork();
}

Result<void> check_pace(double pace) {
    if (std::isfinite(pace) && (pace == 0.0 || (pace >= 1.0 && pace <= RehearsalRunner::pace_max))) return {};
    return Error{
        fmt::format("pace: {} is neither 0 (as fast as it goes) nor within 1 … {}", pace, RehearsalRunner::pace_max)};
}

/// The script's commands that change the timeline, in the order sent.
std::vector<v1::CommandRequest> timeline_changes(const simulation::Scenario& scenario) {
    auto script = scenario.commands;
    std::ranges::stable_sort(script, std::ranges::greater{}, &simulation::ScriptedCommand::send_before_entry_s);
    std::vector<v1::CommandRequest> changes;
    for (const auto& scripted : script) {
        v1::CommandRequest request;
        request.set_command(scripted.command);
        for (const auto& [name, value] : scripted.arguments) {
            auto& argument = *request.add_arguments();
            argument.set_name(name);
            argument.set_value(value);
        }
        if (changes_timeline(request)) changes.push_back(std::move(request));
    }
    return changes;
}

}  // namespace

RehearsalManager::RehearsalManager(const ScenarioLibrary& scenarios, const instruction::PlanLibrary& plans,
                                   const dictionary::Dictionary& dictionary, PipelineThread& pipeline, Post post,
                                   ReadAgain read_again, TimelineQuestions timeline, Callbacks callbacks)
    : scenarios_(scenarios), plans_(plans), dictionary_(dictionary), pipeline_(pipeline), post_(std::move(post)),
      read_again_(std::move(read_again)), timeline_(std::move(timeline)), callbacks_(std::move(callbacks)) {}

RehearsalManager::~RehearsalManager() = default;

Result<void> RehearsalManager::refusal_while_going_on() const {
    if (!closed_.empty()) return Error{closed_};
    if (!going_on()) return {};
    const auto what = state_.run() == 0 ? "a rehearsal begins" : fmt::format("run {} goes on", state_.run());
    return Error{what + ": stop it first, or wait until it has ended"};
}

Result<void> RehearsalManager::check_form(const v1::StartRehearsal& request) const {
    if (auto formed = check_words(request); !formed || flies_again(request)) return formed;
    const auto scenario = scenario_of(request);
    return scenario ? Result<void>{} : Result<void>{scenario.error()};
}

Result<void> RehearsalManager::check_words(const v1::StartRehearsal& request) {
    if (const auto pace = check_pace(request.pace()); !pace) return pace;
    const bool planned = !request.plan().empty() || !request.inline_plan().empty();
    if (flies_again(request)) {
        if (planned) return Error{"plan: a run that is continued or forked goes on by the plan that it has"};
        return request.has_fork() && !request.fork().at().empty()
                   ? archive::check_instant(request.fork().at(), "fork.at")
                   : Result<void>{};
    }
    if (!request.plan().empty() && !request.inline_plan().empty())
        return Error{"plan and inline_plan: one of them, not both"};
    return {};
}

Result<void> RehearsalManager::check_form(const v1::RehearsalControl& control) const {
    switch (control.action_case()) {
    case v1::RehearsalControl::kStart: return check_form(control.start());
    case v1::RehearsalControl::kPause:
    case v1::RehearsalControl::kInject: return {};
    case v1::RehearsalControl::kPace: return check_pace(control.pace());
    case v1::RehearsalControl::kJump:
        return seconds_from_entry(control.jump())
                   ? Result<void>{}
                   : Result<void>{Error{fmt::format("jump: '{}' is no time from entry, such as E-0:47:00",
                                                    control.jump().substr(0, 40))}};
    case v1::RehearsalControl::kStop:
        return control.stop() ? Result<void>{} : Result<void>{Error{"stop: false asks for nothing"}};
    case v1::RehearsalControl::kNote: return check_note(control.note().text(), control.note().by());
    case v1::RehearsalControl::kPlan:
        if (control.plan().inject().empty()) return Error{"plan: the inject's id is wanted"};
        return {};
    case v1::RehearsalControl::ACTION_NOT_SET: break;
    }
    return Error{"the control says nothing: start, pause, pace, jump, stop, inject, note or plan is wanted"};
}

Result<simulation::Scenario> RehearsalManager::scenario_of(const v1::StartRehearsal& request) const {
    if (!request.has_inline_scenario()) return scenarios_.scenario(request.scenario());
    if (!request.scenario().empty()) return Error{"scenario and inline_scenario: one of them, not both"};
    return scenario_from_message(request.inline_scenario());
}

void RehearsalManager::start(const v1::StartRehearsal& request, Began began) {
    if (const auto busy = refusal_while_going_on(); !busy) return began(busy.error());
    if (const auto formed = check_words(request); !formed) return began(formed.error());
    const double pace = request.pace();
    if (flies_again(request))
        return read_again_(request, [this, began = std::move(began), pace](Result<RehearsalRunner::Again> again) {
            post_([this, began, pace, again = std::move(again)]() mutable {
                if (!again) return began(again.error());
                fly_again(std::move(*again), pace, began);
            });
        });
    auto scenario = scenario_of(request);
    if (!scenario) return began(scenario.error());
    auto plan = plan_of(request, *scenario);
    if (!plan) return began(plan.error());
    start({std::move(*scenario), request.seed(), pace, std::move(*plan)}, std::move(began));
}

Result<std::optional<PlannedInjects>> RehearsalManager::plan_of(const v1::StartRehearsal& request,
                                                                const simulation::Scenario& scenario) const {
    if (request.plan().empty() && request.inline_plan().empty()) return std::optional<PlannedInjects>{};
    v1::InstructorPlan given;
    given.set_name("inline_plan");
    given.set_text(request.inline_plan());
    given.set_library(plans_.injects_text());
    if (!request.plan().empty()) {
        auto shipped = plans_.plan(request.plan());
        if (!shipped) return shipped.error();
        given = std::move(*shipped);
    }
    const instruction::CheckFault possible = [&](const v1::FaultInjection& fault) {
        const auto checked = fault_from_message(fault, scenario);
        return checked ? Result<void>{} : Result<void>{checked.error()};
    };
    auto library = instruction::read_library(given.library(), "injects.yaml", dictionary_, {});
    auto read = instruction::read_plan(given.text(), given.name(), dictionary_,
                                       library.injects.value_or(std::vector<instruction::Inject>{}), possible);
    if (!read.plan) return Error{read.findings_text()};
    return std::optional{PlannedInjects{std::move(given), std::move(*read.plan)}};
}

void RehearsalManager::start(Flight flight, Began began) {
    if (const auto busy = refusal_while_going_on(); !busy) return began(busy.error());
    if (const auto script = check_script(flight.scenario, dictionary_); !script) return began(script.error());
    const auto changes = timeline_changes(flight.scenario);
    if (changes.empty()) return fly(std::move(flight), std::move(began));
    timeline_.check(
        archive::RunId{}, changes, false,
        [this, flight = std::move(flight), began = std::move(began), changes](Result<std::string> timeline) {
            post_([this, flight, began, changes, timeline = std::move(timeline)] {
                if (timeline) return fly(flight, began);
                std::string names;
                for (const auto& change : changes) names += (names.empty() ? "" : ", ") + change.command();
                began(Error{fmt::format("commands: its script sends {}: {}", names, timeline.error().message)});
            });
        });
}

void RehearsalManager::fly(Flight flight, Began began) {
    if (const auto busy = refusal_while_going_on(); !busy) return began(busy.error());
    runner_.reset();
    phase_ = Phase::beginning;
    runner_ = std::make_unique<RehearsalRunner>(std::move(flight.scenario), flight.seed, flight.pace, dictionary_,
                                                pipeline_, callbacks_for(std::move(began)), std::move(flight.plan));
}

void RehearsalManager::fly_again(RehearsalRunner::Again again, double pace, Began began) {
    if (const auto busy = refusal_while_going_on(); !busy) return began(busy.error());
    const auto of = fmt::format("the scenario of run {}", again.run.run.value);
    auto scenario = scenario_from_text(again.run.scenario_text, of);
    if (!scenario) return began(scenario.error());
    runner_.reset();
    phase_ = Phase::beginning;
    runner_ = std::make_unique<RehearsalRunner>(std::move(*scenario), std::move(again), pace, dictionary_, pipeline_,
                                                callbacks_for(std::move(began)));
}

RehearsalRunner::Callbacks RehearsalManager::callbacks_for(Began began) {
    RehearsalRunner::Callbacks callbacks;
    callbacks.on_begun = [this, began = std::move(began)](Result<v1::RunState> state) {
        post_([this, began, state = std::move(state)] { begun(state, began); });
    };
    callbacks.on_state = [this](v1::RunState state) {
        post_([this, state = std::move(state)]() mutable {
            state_ = state;
            callbacks_.on_state(std::move(state));
            if (analysis_state_ == AnalysisState::unknown) reanalyse();
        });
    };
    callbacks.on_clocks = [this](v1::Clocks clocks) {
        post_([this, clocks = std::move(clocks)]() mutable { callbacks_.on_clocks(std::move(clocks)); });
    };
    callbacks.on_timeline_moved = [this] {
        post_([this] {
            ++timeline_undone_count_;
            reanalyse();
        });
    };
    callbacks.companion = callbacks_.companion;
    return callbacks;
}

void RehearsalManager::begun(const Result<v1::RunState>& state, const Began& began) {
    if (state) {  // otherwise its runner is over
        phase_ = Phase::under_way;
        state_ = *state;
        callbacks_.on_state(state_);
        reanalyse();  // a crash may have preceded the analysis
    }
    began(state);
}

std::string RehearsalManager::not_going_on(std::uint64_t run) const {
    return fmt::format("run {} is not the one that goes on ({})", run, state_.run());
}

Result<void> RehearsalManager::control(const v1::RehearsalControl& control, Began began) {
    if (control.action_case() == v1::RehearsalControl::kStart) {
        start(control.start(), std::move(began));
        return {};
    }
    return order_of_run(control);
}

Result<void> RehearsalManager::order_of_run(const v1::RehearsalControl& control) {
    if (!going_on()) return Error{"no rehearsal goes on"};
    if (control.run() != 0 && control.run() != state_.run()) return Error{not_going_on(control.run())};
    if (auto formed = check_form(control); !formed) return formed;
    InterveneRun intervene;
    switch (control.action_case()) {
    case v1::RehearsalControl::kPause: return runner_->order(PauseRun{control.pause()});
    case v1::RehearsalControl::kPace: return runner_->order(PaceRun{control.pace()});
    case v1::RehearsalControl::kJump: return runner_->order(JumpRun{seconds_from_entry(control.jump()).value_or(0.0)});
    case v1::RehearsalControl::kStop: return runner_->order(StopRun{});
    case v1::RehearsalControl::kInject: *intervene.intervention.mutable_fault() = control.inject(); break;
    case v1::RehearsalControl::kNote: *intervene.intervention.mutable_note() = control.note(); break;
    case v1::RehearsalControl::kPlan:
        intervene.intervention.set_inject(control.plan().inject());
        if (control.plan().skip()) intervene.intervention.set_skipped(true);
        break;
    case v1::RehearsalControl::kStart:
    case v1::RehearsalControl::ACTION_NOT_SET: break;  // not carried out on a run, and no control
    }
    return runner_->order(std::move(intervene));
}

void RehearsalManager::command(v1::CommandRequest request, const Sender& sender, const Reply& reply) {
    const bool only_check = request.dry_run();
    std::vector<v1::CommandRequest> one;
    one.push_back(std::move(request));
    sequence(std::move(one), only_check, sender,
             [reply](std::vector<v1::CommandReply> replies) { reply(std::move(replies.front())); });
}

void RehearsalManager::sequence(std::vector<v1::CommandRequest> requests, bool only_check, const Sender& sender,
                                Replies replies) {
    receive({std::move(requests), only_check, std::move(replies), sender.browser, sender.director}, sender.authority);
}

void RehearsalManager::receive(SendCommands order, const AuthorityCheck& authority) {
    if (const auto refusal = refusal_of(order); !refusal.empty()) return order.refuse(refusal);
    if (runner_->unknown(order.requests).empty())  // sent again: answered in turn, and no change of anything
        return hand_over(std::move(order), state_.run(), timeline_undone_count_, std::string{});
    if (const auto allowed = room_allows(order); !allowed) return order.refuse(allowed.error().message);
    if (waits(order)) return wait(std::move(order), authority);
    analyse(std::move(order));
}

std::string RehearsalManager::refusal_of(const SendCommands& order) const {
    if (phase() != Phase::under_way) return nobody_listens;
    if (!order.only_check && pipeline_.blocked())
        return "the run waits until its archive can be written again: " + pipeline_.fault();
    for (const auto& request : order.requests)
        if (request.run() != 0 && request.run() != state_.run()) return not_going_on(request.run());
    if (const auto ids = check_client_ids(order.requests); !ids) return ids.error().message;
    return {};
}

Result<void> RehearsalManager::room_allows(const SendCommands& order) const {
    if (order.only_check) return {};
    const auto& positions = pipeline_.positions();
    for (const auto& request : runner_->unknown(order.requests)) {  // one sent again has left already
        const auto& action = request.action();
        const auto allowed = action.empty() || action == "release" ? positions.may_send(request.controller())
                             : action == "approve"                 ? positions.may_approve(request.controller())
                                                                   : positions.may_stop(request.controller());
        if (!allowed) return allowed;
    }
    return {};
}

bool RehearsalManager::waits(const SendCommands& order) const {
    const bool hold = std::ranges::all_of(order.requests,
                                          [](const v1::CommandRequest& request) { return request.action() == "hold"; });
    if (!change_pending_of_ || order.only_check || hold) return false;
    const auto asker = order.asker();
    const bool behind_own = *change_pending_of_ == asker || std::ranges::any_of(waiting_, [&](const Waiting& each) {
        return each.order.asker() == asker;
    });
    return behind_own || std::ranges::any_of(order.requests, changes_timeline);
}

void RehearsalManager::wait(SendCommands order, const AuthorityCheck& authority) {
    const auto own = static_cast<std::size_t>(
        std::ranges::count_if(waiting_, [&](const Waiting& each) { return each.order.asker() == order.asker(); }));
    if (!commands::may_take(own, waiting_.size(), RehearsalRunner::requests_max))
        return order.refuse(
            fmt::format("{} commands wait already until a change of the timeline is decided, {} of them yours",
                        waiting_.size(), own));
    // Numbers and rights refer to this run, not to one that begins meanwhile.
    for (auto& request : order.requests) request.set_run(state_.run());
    waiting_.push_back({std::move(order), authority});
}

void RehearsalManager::analyse(SendCommands order) {
    const auto sent = runner_->unknown(order.requests);
    if (!order.only_check && std::ranges::any_of(sent, changes_timeline)) {
        change_pending_of_ = order.asker();
        order.replies = [this, replies = std::move(order.replies)](std::vector<v1::CommandReply> answers) {
            const auto decided = std::exchange(change_pending_of_, std::nullopt).value_or("");
            replies(std::move(answers));
            change_decided(decided);
        };
    }
    const auto run = state_.run();
    timeline_.check(archive::RunId{static_cast<std::uint32_t>(run)}, sent, order.only_check,
                    [this, run, order, undone_count = timeline_undone_count_](Result<std::string> timeline) {
                        post_([this, run, order, undone_count, timeline = std::move(timeline)] {
                            hand_over(order, run, undone_count, timeline);
                        });
                    });
}

void RehearsalManager::hand_over(SendCommands order, std::uint64_t run, std::uint64_t undone_count,
                                 const Result<std::string>& timeline) {
    if (!timeline) return order.refuse(timeline.error().message);
    if (phase() != Phase::under_way || state_.run() != run) return order.refuse(nobody_listens);
    if (!order.only_check && !timeline->empty() && undone_count != timeline_undone_count_)
        return order.refuse("what it was analysed with has come to nothing meanwhile: look at the timeline, then send "
                            "it again");
    // Asked again: the analysis took time, and the room may have changed its mind.
    if (const auto allowed = room_allows(order); !allowed) return order.refuse(allowed.error().message);
    order.replies = [this, replies = std::move(order.replies),
                     says = *timeline](std::vector<v1::CommandReply> answers) {
        for (auto& answer : answers)
            if (!answer.repeated()) answer.set_timeline(says);
        post_([replies, answers = std::move(answers)] { replies(answers); });
    };
    static_cast<void>(runner_->order(std::move(order)));  // a refusal is in the replies
}

void RehearsalManager::change_decided(const std::string& asker) {
    // The others' turn: changes of one asker, however many, delay another's by one analysis.
    std::ranges::stable_partition(waiting_, [&](const Waiting& each) { return each.order.asker() != asker; });
    for (auto& [order, authority] : std::exchange(waiting_, {})) {
        Result<void> allowed;
        for (const auto& request : order.requests)
            if (allowed) allowed = authority(request);
        if (allowed)
            receive(std::move(order), authority);
        else
            order.refuse(allowed.error().message);
    }
}

void RehearsalManager::reanalyse() {
    if (phase() != Phase::under_way) return;
    const bool in_progress = analysis_state_ == AnalysisState::analysing || analysis_state_ == AnalysisState::outdated;
    analysis_state_ = in_progress ? AnalysisState::outdated : AnalysisState::analysing;
    if (in_progress) return;
    const auto run = state_.run();
    timeline_.reanalyse(archive::RunId{static_cast<std::uint32_t>(run)},
                        [this, run](Result<TimelineCheck::Reanalysis> reanalysis) {
                            post_([this, run, reanalysis = std::move(reanalysis)] { reanalysed(run, reanalysis); });
                        });
}

void RehearsalManager::reanalysed(std::uint64_t run, const Result<TimelineCheck::Reanalysis>& reanalysis) {
    if (std::exchange(analysis_state_, AnalysisState::settled) == AnalysisState::outdated) return reanalyse();
    if (phase() != Phase::under_way || state_.run() != run) return;
    const std::string not_known = reanalysis ? reanalysis->not_known : reanalysis.error().message;
    if (!not_known.empty()) {
        analysis_state_ = AnalysisState::unknown;
        spdlog::warn("run {}: what becomes of the timeline by what waits is not known yet: {}", run, not_known);
    }
    if (reanalysis) tell(*reanalysis);
}

void RehearsalManager::tell(const TimelineCheck::Reanalysis& reanalysis) {
    for (const auto& each : reanalysis.known)
        static_cast<void>(
            runner_->order(commands::TimelineVerdict{each.number, reanalysis.undone, each.refuted, each.words}));
}

}  // namespace aeolis::server
