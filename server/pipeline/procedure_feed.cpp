// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/procedure_feed.hpp"

#include "server/archive/procedure_status.hpp"
#include "server/pipeline/new_records.hpp"
#include "server/pipeline/procedure_status.hpp"
#include "server/procedures/procedure_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::pipeline {
namespace {

using namespace server::procedures;

constexpr std::int64_t second_us = 1'000'000;

std::optional<EntryPrediction> prediction_of(const archive::RunStart& start) {
    if (start.entry == Sclk{}) return {};  // of another mission nobody knows when it enters
    return EntryPrediction{start.correlation.scet_of(start.entry), start.light_time_s};
}

bool same_verdicts(const std::vector<ConditionState>& one, const std::vector<ConditionState>& other) {
    return std::ranges::equal(one, other, {}, &ConditionState::verdict, &ConditionState::verdict);
}

/// Whether the two differ in nothing but evidence.
bool same_state(const StepStatus& one, const StepStatus& other) {
    return one.state == other.state && one.active_since == other.active_since && one.late_since == other.late_since &&
           one.over_since == other.over_since && same_verdicts(one.conditions, other.conditions) &&
           std::ranges::equal(one.choices, other.choices, same_verdicts) && one.signatures == other.signatures &&
           one.by == other.by && one.reason == other.reason && one.chosen == other.chosen &&
           one.command == other.command && one.command_evidence == other.command_evidence;
}
bool same_state(const WatchdogStatus& one, const WatchdogStatus& other) {
    return one.tripped == other.tripped && one.acknowledged == other.acknowledged &&
           same_verdicts(one.conditions, other.conditions);
}

/// The act in the words of the state machine. An Error when its words are none that it knows.
Result<Act> act_of(const archive::ProcedureActRecord& record) {
    const auto kind = act_named(archive::name_of(record.kind));
    const auto position = position_named(record.position);
    if (!kind) return Error{fmt::format("'{}' is no act on a procedure under way", archive::name_of(record.kind))};
    if (!position) return Error{fmt::format("'{}' is no position", record.position)};
    return Act{*kind,          record.step, *position, record.by, record.reason, record.choice.value_or(0),
               record.command, record.ert};
}

}  // namespace

ProcedureFeed::ProcedureFeed(const dictionary::Dictionary& dictionary, const archive::PacketColumns& columns,
                             const archive::RunStart& start)
    : dictionary_(dictionary), columns_(columns), board_(dictionary), prediction_(prediction_of(start)) {}

void ProcedureFeed::follow(const archive::Batch& batch, const std::vector<std::optional<LatestValue>>& latest) {
    if (batch.last_seq <= followed_) return;
    if (!batch.packets.empty())
        newest_ = std::max(newest_.value_or(batch.packets.back().ert), batch.packets.back().ert);
    if (under_way_ > 0)
        each_new(batch.samples, followed_, [&](const archive::SampleRecord& sample) {
            if (sample.source == archive::Source::recorded) return;
            const auto& channels = columns_.channels(sample.packet);
            for (std::size_t column = 0; column < sample.values.count; ++column) {
                const auto& newest = latest[channels[column].value];
                if (newest && newest->sclk > sample.sclk) continue;
                const double value = batch.values[sample.values.first + column];
                board_.on(ChannelSample{channels[column], std::isnan(value) ? std::nullopt : std::optional{value},
                                        sample.ert});
            }
        });
    each_new(batch.events, followed_, [&](const archive::EventRecord& event) {
        if (event.source == archive::Source::recorded || event.duplicate) return;
        events_[event.id] = event.ert;
        if (under_way_ > 0) board_.on(EventReceived{event.id, event.ert});
    });
    if (under_way_ > 0)
        each_new(batch.stages, followed_, [&](const archive::StageRecord& stage) {
            CommandFate fate{stage.command, stage.name, stage.stage, stage.status, stage.evidence, stage.ert, {}};
            if (const auto* command = stage.octets.empty() ? nullptr : dictionary_.command(stage.name))
                if (auto arguments = commands::decode(*command, stage.octets)) fate.arguments = std::move(*arguments);
            board_.on(fate);
        });
    followed_ = batch.last_seq;
}

std::vector<archive::ProcedureStatusRecord> ProcedureFeed::pass(Ert now) {
    now_ = now;
    newest_ = std::max(newest_.value_or(now), now);
    std::vector<archive::ProcedureStatusRecord> statuses;
    if (under_way_ == 0) return statuses;
    board_.pass(now);
    for (std::size_t i = 0; i < told_.size(); ++i)
        if (!told_[i].over && is_due(board_.executions()[i], told_[i], now))
            statuses.push_back(tell(static_cast<std::uint32_t>(i + 1), now));
    return statuses;
}

std::vector<archive::ProcedureStatusRecord> ProcedureFeed::pass() {
    return now_ ? pass(*now_) : std::vector<archive::ProcedureStatusRecord>{};
}

bool ProcedureFeed::is_due(const Execution& execution, const Told& told, Ert now) const {
    const auto same = [](const auto& one, const auto& other) { return same_state(one, other); };
    if (execution.part() != told.part || execution.held() != told.held ||
        !std::ranges::equal(execution.steps(), told.steps, same) ||
        !std::ranges::equal(execution.watchdogs(), told.watchdogs, same))
        return true;
    constexpr auto every_us = static_cast<std::int64_t>(evidence_every_s * second_us);
    return now.microseconds - told.at.microseconds >= every_us &&
           (execution.steps() != told.steps || execution.watchdogs() != told.watchdogs);
}

archive::ProcedureStatusRecord ProcedureFeed::tell(std::uint32_t number, Ert now) {
    const Execution& execution = board_.executions()[number - 1];
    Told& told = told_[number - 1];
    auto status = status_of(execution, dictionary_);
    status.set_number(number);
    status.set_begun_by(told.begun_by);
    told.at = now;
    told.part = execution.part();
    told.held = execution.held();
    if (execution.over()) {
        told.over = true;
        told.steps = {};
        told.watchdogs = {};
        --under_way_;
    } else {
        told.steps = execution.steps();
        told.watchdogs = execution.watchdogs();
    }
    archive::ProcedureStatusRecord record;
    record.ert = now;
    record.number = number;
    record.procedure = told.procedure;
    record.part = std::string(name_of(execution.part()));
    record.held = told.held;
    record.status = archive::packed(status);
    return record;
}

Result<std::uint32_t> ProcedureFeed::begin(const archive::ProcedureActRecord& act,
                                           const std::vector<std::optional<LatestValue>>& latest) {
    const auto position = position_named(act.position);
    if (!position) return Error{fmt::format("'{}' is no position", act.position)};
    auto read = read_procedure(act.text, act.procedure + ".yaml", dictionary_);
    if (!read.procedure)
        return Error{fmt::format("procedure {} breaks a rule: {}", act.procedure, read.findings.front().text())};
    ReceivedFacts facts;
    if (prediction_) facts.predict(*prediction_);
    for (std::size_t channel = 0; channel < latest.size(); ++channel)
        if (const auto& value = latest[channel])
            facts.on(ChannelSample{ChannelId{static_cast<std::uint16_t>(channel)}, value->value, value->ert});
    for (const auto& [event, received] : events_) facts.on(EventReceived{event, received});
    board_.know(std::move(facts));
    const auto number = board_.begin(std::make_shared<const Procedure>(std::move(*read.procedure)), act.ert);
    if (!number) return number.error();
    Told told;
    told.procedure = act.procedure;
    told.begun_by = fmt::format("{} ({})", act.by, act.position);
    told_.push_back(std::move(told));
    ++under_way_;
    return *number;
}

Result<void> ProcedureFeed::take(const archive::ProcedureActRecord& record) {
    const auto act = act_of(record);
    if (!act) return act.error();
    // Tried on a copy: one that is refused moves the clock, and leaves no item by which it could be repeated.
    if (record.number > 0 && record.number <= board_.executions().size())
        if (auto tried = Execution{board_.executions()[record.number - 1]}.on(*act); !tried) return tried;
    return board_.on(record.number, *act);
}

Result<archive::ProcedureStatusRecord> ProcedureFeed::repeat(const archive::ProcedureActRecord& act,
                                                             const std::vector<std::optional<LatestValue>>& latest) {
    std::uint32_t number = act.number;
    if (act.kind == archive::ProcedureActKind::begin) {
        const auto begun = begin(act, latest);
        if (!begun) return begun.error();
        number = *begun;
    } else if (auto taken = take(act); !taken) {
        return taken.error();
    }
    ++acts_;
    return tell(number, act.ert);
}

Ert ProcedureFeed::moved(Ert at) const {
    return newest_ ? std::clamp(at, *newest_, Ert{newest_->microseconds + second_us}) : at;
}

Result<ProcedureFeed::Acted> ProcedureFeed::act(archive::ProcedureActRecord act,
                                                const std::vector<std::optional<LatestValue>>& latest) {
    if (acts_ >= acts_max)
        return Error{
            fmt::format("{} acts on procedures were taken in this run, which is as many as there may be", acts_max)};
    act.ert = moved(act.ert);
    if (act.kind == archive::ProcedureActKind::begin) {
        act.number = static_cast<std::uint32_t>(told_.size() + 1);
    } else {
        if (act.number == 0 || act.number > told_.size())
            return Error{fmt::format("there is no procedure of the number {} in this run", act.number)};
        act.procedure = told_[act.number - 1].procedure;
    }
    auto status = repeat(act, latest);
    if (!status) return status.error();
    return Acted{std::move(act), std::move(*status)};
}

}  // namespace aeolis::pipeline
