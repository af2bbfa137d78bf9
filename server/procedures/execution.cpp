// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/execution.hpp"

#include "common/check.hpp"
#include "server/procedures/step_order.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

constexpr std::array act_kinds{Act::Kind::tick,    Act::Kind::sign,        Act::Kind::choose,
                               Act::Kind::skip,    Act::Kind::sent,        Act::Kind::hold,
                               Act::Kind::release, Act::Kind::acknowledge, Act::Kind::stop};

Since since_of(const Condition& condition) {
    if (const auto* channel = std::get_if<ChannelCondition>(&condition)) return channel->since;
    if (const auto* event = std::get_if<EventCondition>(&condition)) return event->since;
    return Since::run;
}

}  // namespace

std::string_view name_of(StepState state) {
    switch (state) {
    case StepState::waiting: return "waiting";
    case StepState::held: return "held";
    case StepState::active: return "active";
    case StepState::late: return "late";
    case StepState::checked: return "checked";
    case StepState::ticked: return "ticked";
    case StepState::skipped: return "skipped";
    case StepState::not_taken: return "not_taken";
    }
    return "";
}

std::string_view name_of(Part part) {
    switch (part) {
    case Part::preconditions: return "preconditions";
    case Part::body: return "body";
    case Part::confirmation: return "confirmation";
    case Part::confirmed: return "confirmed";
    case Part::ended: return "ended";
    case Part::stopped: return "stopped";
    }
    return "";
}

std::string_view name_of(Act::Kind kind) {
    switch (kind) {
    case Act::Kind::tick: return "tick";
    case Act::Kind::sign: return "sign";
    case Act::Kind::choose: return "choose";
    case Act::Kind::skip: return "skip";
    case Act::Kind::sent: return "sent";
    case Act::Kind::hold: return "hold";
    case Act::Kind::release: return "release";
    case Act::Kind::acknowledge: return "acknowledge";
    case Act::Kind::stop: return "stop";
    }
    return "";
}

std::optional<Act::Kind> act_named(std::string_view name) {
    for (const Act::Kind kind : act_kinds)
        if (name_of(kind) == name) return kind;
    return std::nullopt;
}

Execution::Execution(std::shared_ptr<const Procedure> procedure, const dictionary::Dictionary& dictionary, Ert begun,
                     const ReceivedFacts& before)
    : procedure_(std::move(procedure)), begun_(begun), watch_(dictionary) {
    AEOLIS_CHECK(procedure_ != nullptr && !procedure_->body.empty());
    for (const auto* part : {&procedure_->preconditions, &procedure_->body, &procedure_->confirmation})
        for (const Step& step : *part) {
            steps_.push_back(&step);
            Numbers& numbers = numbers_.emplace_back();
            watch_conditions(step.conditions, numbers.conditions);
            numbers.choices.reserve(step.choices.size());
            for (const Choice& choice : step.choices)
                watch_conditions(choice.conditions, numbers.choices.emplace_back());
        }
    watchdog_numbers_.reserve(procedure_->watchdogs.size());
    for (const Watchdog& watchdog : procedure_->watchdogs)
        watch_conditions(watchdog.conditions, watchdog_numbers_.emplace_back());
    status_.resize(steps_.size());
    paused_us_.resize(steps_.size());
    watchdogs_.resize(procedure_->watchdogs.size());
    watch_.know(before);
    watch_.pass(begun);
    begin_part(Part::preconditions);
    settle();
}

void Execution::watch_conditions(const std::vector<Condition>& conditions, std::vector<std::size_t>& numbers) {
    numbers.reserve(conditions.size());
    for (const Condition& condition : conditions) numbers.push_back(watch_.add(condition));
}

// ---- what is received ----------------------------------------------------------------------------------------------

void Execution::on(const ChannelSample& sample) {
    if (watch_.on(sample)) settle();
}

void Execution::on(const EventReceived& event) {
    if (watch_.on(event)) settle();
}

void Execution::on(const CommandFate& fate) {
    watch_.pass(fate.at);
    if (fates_.size() < commands_followed_max || fates_.contains(fate.command)) {
        Fate& known = fates_[fate.command];
        known.name = fate.name;
        known.status[static_cast<std::size_t>(fate.stage)] = fate.status;
        if (fate.stage == commands::Stage::queued) known.sent = fate.arguments;
        known.text = fmt::format("{} {}: {}", name_of(fate.stage), name_of(fate.status), fate.evidence);
    }
    settle();
}

void Execution::predict(const EntryPrediction& prediction) {
    watch_.predict(prediction);
    settle();
}

void Execution::pass(Ert now) {
    watch_.pass(now);
    settle();
}

// ---- how steps follow each other -----------------------------------------------------------------------------------

Execution::Range Execution::range_of(Part part) const {
    const std::size_t body = procedure_->preconditions.size(), confirmation = body + procedure_->body.size();
    switch (part) {
    case Part::preconditions: return {0, body};
    case Part::body: return {body, confirmation};
    case Part::confirmation: return {confirmation, steps_.size()};
    default: return {0, 0};
    }
}

const StepStatus* Execution::step(std::string_view id) const {
    const auto found = std::ranges::find_if(steps_, [&](const Step* one) { return one->id == id; });
    return found == steps_.end() ? nullptr : &status_[static_cast<std::size_t>(found - steps_.begin())];
}

/// Whether the step is active, whatever holds the procedure.
bool Execution::stands_open(std::size_t index) const {
    return status_[index].active_since && !is_over(status_[index].state);
}

std::vector<ConditionState> Execution::judge(const std::vector<Condition>& conditions,
                                             const std::vector<std::size_t>& numbers, Ert step_since) const {
    std::vector<ConditionState> states;
    states.reserve(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        std::optional<Ert> since;
        switch (since_of(conditions[i])) {
        case Since::run: break;
        case Since::procedure: since = begun_; break;
        case Since::step: since = step_since; break;
        }
        states.push_back(watch_.judge(numbers[i], since));
    }
    return states;
}

void Execution::look_at_watchdogs() {
    for (std::size_t i = 0; i < watchdogs_.size(); ++i) {
        const Watchdog& watchdog = procedure_->watchdogs[i];
        WatchdogStatus& status = watchdogs_[i];
        if (status.tripped) continue;  // its evidence is what it was then
        status.conditions = judge(watchdog.conditions, watchdog_numbers_[i], begun_);
        if (!all_hold(status.conditions)) continue;
        status.tripped = watch_.now();
        if (watchdog.hold && held_.empty()) set_held(fmt::format("watchdog {}", watchdog.id), {});
    }
}

std::optional<Ert> Execution::limit(std::size_t index) const {
    const Step& step = *steps_[index];
    if (is_over(status_[index].state)) return {};
    std::optional<Ert> limit;
    if (step.limit_s && held_.empty() && status_[index].active_since)
        limit =
            Ert{status_[index].active_since->microseconds + std::llround(*step.limit_s * 1.0e6) + paused_us_[index]};
    // By when a command is to leave: once it was radiated, its evidence may take the way there and back.
    const bool left = step.limit_e && step.limit_e->where == EntryTime::Where::sent &&
                      command_has(index, commands::Stage::radiated, commands::Status::ok);
    if (step.limit_e && !left && watch_.prediction()) {
        const Ert by = instant_of(*step.limit_e, *watch_.prediction());
        limit = limit ? std::min(*limit, by) : by;
    }
    return limit;
}

std::optional<Ert> Execution::limit_passed(std::size_t index) const {
    const auto limit = this->limit(index);
    return limit && *limit < watch_.now() ? limit : std::nullopt;
}

/// Judges an active step anew.
void Execution::look(std::size_t index) {
    const Step& step = *steps_[index];
    StepStatus& status = status_[index];
    const Ert since = *status.active_since;
    status.conditions = judge(step.conditions, numbers_[index].conditions, since);
    status.choices.resize(step.choices.size());
    for (std::size_t i = 0; i < step.choices.size(); ++i)
        status.choices[i] = judge(step.choices[i].conditions, numbers_[index].choices[i], since);
    if (status.command)
        if (const auto fate = fates_.find(*status.command); fate != fates_.end())
            status.command_evidence = fate->second.text;
    if (!status.late_since) status.late_since = limit_passed(index);
    status.state = !held_.empty() ? StepState::held : status.late_since ? StepState::late : StepState::active;
    if (held_.empty() && is_done(index)) {
        const bool by_itself = status.by.empty() && (step.command || !step.conditions.empty());
        end_step(index, by_itself ? StepState::checked : StepState::ticked);
    }
}

bool Execution::is_done(std::size_t index) const {
    const Step& step = *steps_[index];
    const StepStatus& status = status_[index];
    if (status.signatures.size() < step.signatures.size()) return false;
    if (!step.choices.empty()) return status.chosen.has_value();
    if (!status.by.empty()) return true;
    if (step.command) {
        if (!command_has(index, step.command->until, commands::Status::ok)) return false;
    } else if (step.conditions.empty()) {
        return !step.signatures.empty();  // to sign it was all there was to do
    }
    return all_hold(status.conditions);
}

void Execution::activate(std::size_t index) {
    status_[index].active_since = watch_.now();
    status_[index].state = StepState::active;
}

void Execution::begin_step(std::size_t index) {
    if (steps_[index]->hold)
        status_[index].state = StepState::held;
    else
        activate(index);
}

void Execution::end_step(std::size_t index, StepState state) {
    status_[index].state = state;
    status_[index].over_since = watch_.now();
}

void Execution::begin_part(Part part) {
    part_ = part;
    const auto [first, end] = range_of(part);
    if (part == Part::body) {
        current_ = 0;
        begin_step(first);
        return;
    }
    for (std::size_t index = first; index < end; ++index) begin_step(index);
}

void Execution::finish(Part part) {
    part_ = part;
    for (std::size_t index = 0; index < status_.size(); ++index)
        if (!is_over(status_[index].state)) end_step(index, StepState::not_taken);
}

/// Goes on to what follows, once what is under way is over. @return whether it did
bool Execution::advance() {
    const auto [first, end] = range_of(part_);
    if (part_ == Part::body) {
        const StepStatus& status = status_[first + current_];
        if (!is_over(status.state)) return false;
        const auto ways = ways_on(procedure_->body, current_);
        const Target way = ways[status.chosen.value_or(0)];
        switch (way.kind) {
        case Target::Kind::step:
            current_ = way.step;
            begin_step(first + current_);
            return true;
        case Target::Kind::confirmation: begin_part(Part::confirmation); return true;
        case Target::Kind::end: finish(Part::ended); return false;
        }
    }
    for (std::size_t index = first; index < end; ++index)
        if (!is_over(status_[index].state)) return false;
    if (part_ == Part::preconditions) {
        begin_part(Part::body);
        return true;
    }
    const bool left_out = std::any_of(status_.begin() + static_cast<std::ptrdiff_t>(first), status_.end(),
                                      [](const auto& status) { return status.state == StepState::skipped; });
    finish(left_out ? Part::ended : Part::confirmed);
    return false;
}

void Execution::settle() {
    if (over()) return;
    look_at_watchdogs();
    do {
        const auto [first, end] = range_of(part_);
        for (std::size_t index = first; index < end; ++index)
            if (stands_open(index)) look(index);
    } while (held_.empty() && advance());
}

}  // namespace aeolis::server::procedures
