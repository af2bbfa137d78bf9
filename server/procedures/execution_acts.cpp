// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/execution.hpp"

#include "commands/encoder.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

/// "rate=0.2 where rate=0.1 is prepared": an argument that was sent with another value than the step prepares, or of
/// which nobody knows with which.
std::optional<std::string> other_arguments(const PreparedCommand& prepared,
                                           const std::vector<commands::NamedValue>& sent) {
    for (const commands::NamedValue& fixed : prepared.fixed) {
        const auto found = std::ranges::find(sent, fixed.name, &commands::NamedValue::name);
        if (found != sent.end() && found->value == fixed.value) continue;
        const std::string was = found != sent.end() ? commands::arguments_text(std::span{&*found, 1})
                                                    : fmt::format("no known {}", fixed.name);
        return fmt::format("{} where {} is prepared", was, commands::arguments_text(std::span{&fixed, 1}));
    }
    return {};
}

std::string first_not_held(const std::vector<ConditionState>& states) {
    const auto one = std::ranges::find_if(states, [](const auto& state) { return state.verdict != Verdict::holds; });
    return one == states.end() ? std::string{} : fmt::format("{} ({})", name_of(one->verdict), one->evidence);
}

std::string who(const Act& act) {
    return fmt::format("{} ({})", act.person, name_of(act.position));
}

/// Whether the act comes from the step's position, or from the flight director.
bool may_act(const Act& act, Position position) {
    return act.position == position || act.position == Position::flight_director;
}

}  // namespace

Result<void> Execution::on(const Act& act) {
    watch_.pass(act.at);
    settle();
    const auto taken = take(act);
    settle();
    return taken;
}

Result<void> Execution::take(const Act& act) {
    if (over()) return Error{fmt::format("the procedure is over: {}", name_of(part_))};
    if (act.person.empty() || act.person.size() > person_octets_max)
        return Error{fmt::format("whoever acts gives a name, of {} characters at most", person_octets_max)};
    if (act.reason.size() > reason_octets_max)
        return Error{fmt::format("a reason has {} characters at most", reason_octets_max)};
    switch (act.kind) {
    case Act::Kind::tick: return tick(act);
    case Act::Kind::sign: return sign(act);
    case Act::Kind::choose: return choose(act);
    case Act::Kind::skip: return skip(act);
    case Act::Kind::sent: return sent(act);
    case Act::Kind::hold: return hold(act);
    case Act::Kind::release: return release(act);
    case Act::Kind::acknowledge: return acknowledge(act);
    case Act::Kind::stop:
        if (act.position != Position::flight_director) return Error{"only the flight director stops a procedure"};
        if (act.reason.empty()) return Error{"to stop a procedure needs a reason"};
        finish(Part::stopped);
        return {};
    }
    return Error{"no such act"};
}

/// The step that the act names, if it is active.
Result<std::size_t> Execution::open_step(const Act& act) const {
    const auto found = std::ranges::find_if(steps_, [&](const Step* one) { return one->id == act.step; });
    if (found == steps_.end()) return Error{fmt::format("'{}' is no step of {}", act.step, procedure_->id)};
    const auto index = static_cast<std::size_t>(found - steps_.begin());
    if (!stands_open(index))
        return Error{fmt::format("step {} is {}, not active", act.step, name_of(status_[index].state))};
    if (!held_.empty() && act.kind != Act::Kind::sent) return Error{fmt::format("the procedure is held: {}", held_)};
    return index;
}

Result<void> Execution::tick(const Act& act) {
    const auto index = open_step(act);
    if (!index) return index.error();
    const Step& step = *steps_[*index];
    StepStatus& status = status_[*index];
    if (!may_act(act, step.who))
        return Error{fmt::format("step {} is ticked by {} or the flight director", step.id, name_of(step.who))};
    if (step.command) return Error{fmt::format("step {} is done by its command, which nobody ticks", step.id)};
    if (!step.choices.empty()) return Error{fmt::format("step {} is a branch: choose one of its ways", step.id)};
    if (act.reason.empty() && !all_hold(status.conditions))
        return Error{fmt::format("step {}: its condition {}; to tick it all the same needs a reason", step.id,
                                 first_not_held(status.conditions))};
    status.by = who(act);
    status.reason = act.reason;
    return {};
}

Result<void> Execution::sign(const Act& act) {
    const auto index = open_step(act);
    if (!index) return index.error();
    const Step& step = *steps_[*index];
    auto& signatures = status_[*index].signatures;
    if (std::ranges::find(step.signatures, act.position) == step.signatures.end())
        return Error{fmt::format("step {} needs no signature of {}", step.id, name_of(act.position))};
    if (std::ranges::find(signatures, act.position, &Signature::position) != signatures.end())
        return Error{fmt::format("step {} is already signed by {}", step.id, name_of(act.position))};
    signatures.push_back({act.position, act.person, watch_.now()});
    return {};
}

Result<void> Execution::choose(const Act& act) {
    const auto index = open_step(act);
    if (!index) return index.error();
    const Step& step = *steps_[*index];
    StepStatus& status = status_[*index];
    if (step.choices.empty()) return Error{fmt::format("step {} is no branch", step.id)};
    if (!may_act(act, step.who))
        return Error{fmt::format("step {} is decided by {} or the flight director", step.id, name_of(step.who))};
    if (act.choice >= step.choices.size())
        return Error{
            fmt::format("step {} has {} ways, none of the number {}", step.id, step.choices.size(), act.choice)};
    if (status.signatures.size() < step.signatures.size())
        return Error{fmt::format("step {} lacks signatures: {} of {}", step.id, status.signatures.size(),
                                 step.signatures.size())};
    for (const auto* states : {&status.conditions, &status.choices[act.choice]})
        if (act.reason.empty() && !all_hold(*states))
            return Error{fmt::format("step {}: a condition of this way {}; to go it all the same needs a reason",
                                     step.id, first_not_held(*states))};
    status.chosen = act.choice;
    status.by = who(act);
    status.reason = act.reason;
    return {};
}

Result<void> Execution::skip(const Act& act) {
    const auto index = open_step(act);
    if (!index) return index.error();
    if (act.position != Position::flight_director) return Error{"only the flight director skips a step"};
    if (act.reason.empty()) return Error{fmt::format("to skip step {} needs a reason", act.step)};
    if (!steps_[*index]->choices.empty())
        return Error{fmt::format("step {} is a branch: choose one of its ways", act.step)};
    status_[*index].by = who(act);
    status_[*index].reason = act.reason;
    end_step(*index, StepState::skipped);
    return {};
}

Result<void> Execution::sent(const Act& act) {
    const auto index = open_step(act);
    if (!index) return index.error();
    const Step& step = *steps_[*index];
    StepStatus& status = status_[*index];
    if (!step.command) return Error{fmt::format("step {} has no command", step.id)};
    if (act.position != Position::command) return Error{"only the position command sends"};
    if (act.command == 0) return Error{"a command that was sent has a number"};
    if (status.command && !command_has(*index, commands::Status::failed)) {
        if (!command_has(*index, commands::Status::unknown))
            return Error{fmt::format("step {}: its command was sent as number {}, and has not failed", step.id,
                                     *status.command)};
        if (act.reason.empty())
            return Error{fmt::format("step {}: of its command, number {}, something is not known; to send it again "
                                     "needs a reason",
                                     step.id, *status.command)};
    }
    const auto fate = fates_.find(act.command);
    if (fate == fates_.end() || !fate->second.sent)
        return Error{fmt::format("no command of the number {} was sent since this procedure was begun", act.command)};
    if (fate->second.name != step.command->name)
        return Error{fmt::format("command {} is {}, and step {} has {}", act.command, fate->second.name, step.id,
                                 step.command->name)};
    if (const auto other = other_arguments(*step.command, *fate->second.sent); other && act.reason.empty())
        return Error{fmt::format("command {} has {}; to take it for that of step {} needs a reason", act.command,
                                 *other, step.id)};
    status.command = act.command;
    status.command_evidence = fate->second.text;
    if (!act.reason.empty()) status.reason = act.reason;
    return {};
}

/// Whether the step stands at the hold before it.
bool Execution::waits_for_release(std::size_t index) const {
    return status_[index].state == StepState::held && !status_[index].active_since;
}

/// Whether any stage of the step's command has this status.
bool Execution::command_has(std::size_t index, commands::Status status) const {
    const auto fate = fates_.find(status_[index].command.value_or(0));
    return fate != fates_.end() && std::ranges::find(fate->second.status, status) != fate->second.status.end();
}

bool Execution::command_has(std::size_t index, commands::Stage stage, commands::Status status) const {
    const auto fate = fates_.find(status_[index].command.value_or(0));
    return fate != fates_.end() && fate->second.status[static_cast<std::size_t>(stage)] == status;
}

std::vector<Act::Kind> Execution::acts() const {
    if (over()) return {};
    return {held_.empty() ? Act::Kind::hold : Act::Kind::release, Act::Kind::stop};
}

std::vector<Act::Kind> Execution::acts_of_step(std::size_t index) const {
    std::vector<Act::Kind> kinds;
    if (over()) return kinds;
    const Step& step = *steps_[index];
    const StepStatus& status = status_[index];
    if (held_.empty() && waits_for_release(index)) kinds.push_back(Act::Kind::release);
    if (!stands_open(index)) return kinds;
    if (step.command && (!status.command || command_has(index, commands::Status::failed) ||
                         command_has(index, commands::Status::unknown)))
        kinds.push_back(Act::Kind::sent);
    if (!held_.empty()) return kinds;
    const bool is_signed = status.signatures.size() == step.signatures.size();
    if (!step.command && step.choices.empty() && status.by.empty()) kinds.push_back(Act::Kind::tick);
    if (!is_signed) kinds.push_back(Act::Kind::sign);
    if (!step.choices.empty() && is_signed) kinds.push_back(Act::Kind::choose);
    if (step.choices.empty()) kinds.push_back(Act::Kind::skip);
    return kinds;
}

std::vector<Act::Kind> Execution::acts_of_watchdog(std::size_t watchdog) const {
    const WatchdogStatus& status = watchdogs_[watchdog];
    if (over() || !status.tripped || status.acknowledged) return {};
    return {Act::Kind::acknowledge};
}

void Execution::set_held(std::string why, std::string person) {
    held_ = std::move(why);
    held_by_ = std::move(person);
    held_since_ = watch_.now();
}

Result<void> Execution::hold(const Act& act) {
    if (!held_.empty()) return Error{fmt::format("the procedure is held already: {}", held_)};
    if (act.reason.empty()) return Error{"to hold a procedure needs a reason"};
    set_held(fmt::format("{}: {}", who(act), act.reason), act.person);
    return {};
}

Result<void> Execution::release(const Act& act) {
    if (!act.step.empty()) {
        const auto found = std::ranges::find_if(steps_, [&](const Step* one) { return one->id == act.step; });
        if (found == steps_.end()) return Error{fmt::format("'{}' is no step of {}", act.step, procedure_->id)};
        const auto index = static_cast<std::size_t>(found - steps_.begin());
        StepStatus& status = status_[index];
        if (!waits_for_release(index))
            return Error{fmt::format("step {} is {}, not at its hold", act.step, name_of(status.state))};
        if (!may_act(act, *(*found)->hold))
            return Error{
                fmt::format("step {} is released by {} or the flight director", act.step, name_of(*(*found)->hold))};
        if (!held_.empty()) return Error{fmt::format("the procedure is held: {}", held_)};
        activate(index);
        return {};
    }
    if (held_.empty()) return Error{"the procedure is not held"};
    if (act.position != Position::flight_director && act.person != held_by_)
        return Error{"the procedure is released by whoever holds it, or by the flight director"};
    for (std::size_t index = 0; index < status_.size(); ++index)
        if (stands_open(index))
            paused_us_[index] +=
                watch_.now().microseconds - std::max(held_since_, *status_[index].active_since).microseconds;
    held_.clear();
    held_by_.clear();
    return {};
}

Result<void> Execution::acknowledge(const Act& act) {
    const auto found = std::ranges::find(procedure_->watchdogs, act.step, &Watchdog::id);
    if (found == procedure_->watchdogs.end())
        return Error{fmt::format("'{}' is no watchdog of {}", act.step, procedure_->id)};
    WatchdogStatus& status = watchdogs_[static_cast<std::size_t>(found - procedure_->watchdogs.begin())];
    if (!status.tripped) return Error{fmt::format("watchdog {} has not tripped", act.step)};
    if (status.acknowledged) return Error{fmt::format("watchdog {} is already acknowledged", act.step)};
    if (!may_act(act, found->who))
        return Error{
            fmt::format("watchdog {} is acknowledged by {} or the flight director", act.step, name_of(found->who))};
    status.acknowledged = Signature{act.position, act.person, watch_.now()};
    return {};
}

}  // namespace aeolis::server::procedures
