// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/condition_watch.hpp"

#include "commands/number.hpp"
#include "commands/preconditions.hpp"
#include "common/check.hpp"
#include "server/procedures/condition.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

double seconds_between(Ert from, Ert to) {
    return static_cast<double>(to.microseconds - from.microseconds) * 1.0e-6;
}

}  // namespace

Ert instant_of(const EntryTime& time, const EntryPrediction& prediction) {
    double after_s = time.e_s;
    if (time.where == EntryTime::Where::sent) after_s -= prediction.light_time_s;
    if (time.where == EntryTime::Where::received) after_s += prediction.light_time_s;
    return {prediction.entry.microseconds + std::llround(after_s * 1.0e6)};
}

std::string_view name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::does_not_hold: return "does not hold";
    case Verdict::not_known: break;
    }
    return "not known";
}

bool all_hold(const std::vector<ConditionState>& states) {
    return std::ranges::all_of(states, [](const auto& one) { return one.verdict == Verdict::holds; });
}

std::size_t ConditionWatch::add(const Condition& condition) {
    AEOLIS_CHECK(heard_.empty());
    if (const auto* of_channel = std::get_if<ChannelCondition>(&condition)) {
        AEOLIS_CHECK(of_channel->channel.value < dictionary_->channels.size());
        by_channel_[of_channel->channel].push_back(watched_.size());
    }
    if (const auto* of_event = std::get_if<EventCondition>(&condition)) events_.try_emplace(of_event->event);
    watched_.push_back({condition, {}});
    return watched_.size() - 1;
}

void ConditionWatch::know(const ReceivedFacts& before) {
    for (const auto& [channel, conditions] : by_channel_)
        if (const auto sample = before.latest().find(channel); sample != before.latest().end()) on(sample->second);
    for (auto& [event, last] : events_)
        if (const auto received = before.events().find(event); received != before.events().end())
            on(EventReceived{event, received->second});
    prediction_ = before.prediction();
}

bool ConditionWatch::on(const ChannelSample& sample) {
    pass(sample.received);
    const auto conditions = by_channel_.find(sample.channel);
    if (conditions == by_channel_.end()) return false;
    const auto [heard, is_first] = heard_.try_emplace(sample.channel);
    const bool gap = is_first || seconds_between(heard->second.received, sample.received) > commands::stale_after_s;
    heard->second = {sample.value, sample.received};
    for (const std::size_t number : conditions->second) {
        Watched& watched = watched_[number];
        const auto& condition = std::get<ChannelCondition>(watched.condition);
        if (!sample.value || !holds(condition.comparison, *sample.value, condition.value))
            watched.held_since.reset();
        else if (!watched.held_since || gap)
            watched.held_since = sample.received;
    }
    return true;
}

bool ConditionWatch::on(const EventReceived& event) {
    pass(event.received);
    const auto known = events_.find(event.event);
    if (known == events_.end()) return false;
    known->second = event.received;
    return true;
}

void ConditionWatch::pass(Ert now) {
    now_ = std::max(now_, now);
}

ConditionState ConditionWatch::judge(std::size_t number, std::optional<Ert> since) const {
    AEOLIS_CHECK(number < watched_.size());
    const Watched& watched = watched_[number];
    if (const auto* of_channel = std::get_if<ChannelCondition>(&watched.condition))
        return judge_channel(watched, *of_channel, since);
    if (const auto* of_event = std::get_if<EventCondition>(&watched.condition)) return judge_event(*of_event, since);
    return judge_time(std::get<TimeCondition>(watched.condition));
}

ConditionState ConditionWatch::judge_channel(const Watched& watched, const ChannelCondition& condition,
                                             std::optional<Ert> since) const {
    const auto& channel = dictionary_->channels[condition.channel.value];
    const auto heard = heard_.find(condition.channel);
    if (heard == heard_.end()) return {Verdict::not_known, channel.name + " was never received"};
    const auto& [value, received] = heard->second;
    const std::string when = day_of_year_text(received);
    if (const double age_s = seconds_between(received, now_); age_s > commands::stale_after_s)
        return {Verdict::not_known,
                fmt::format("{} was last received {}, {} s ago", channel.name, when, std::floor(age_s))};
    if (since && received < *since)
        return {Verdict::not_known, fmt::format("{} was last received {}, before that", channel.name, when)};
    if (!value) return {Verdict::not_known, fmt::format("{} is undefined on board, received {}", channel.name, when)};
    std::string evidence = fmt::format("{} is {}, received {}", channel.name, exact_text(channel.type, *value), when);
    if (!watched.held_since) return {Verdict::does_not_hold, std::move(evidence)};
    if (condition.for_s <= 0.0) return {Verdict::holds, std::move(evidence)};
    const Ert from = since ? std::max(*since, *watched.held_since) : *watched.held_since;
    const double held_s = seconds_between(from, received);
    evidence += fmt::format(", so for {} s", commands::shortest_text(held_s));
    return {held_s >= condition.for_s ? Verdict::holds : Verdict::does_not_hold, std::move(evidence)};
}

ConditionState ConditionWatch::judge_event(const EventCondition& condition, std::optional<Ert> since) const {
    const auto* event = dictionary_->event(condition.event);
    AEOLIS_CHECK(event != nullptr);
    const auto& last = events_.at(condition.event);
    if (!last) return {Verdict::does_not_hold, event->name + " was never received"};
    const std::string when = day_of_year_text(*last);
    if (since && *last < *since)
        return {Verdict::does_not_hold, fmt::format("{} was last received {}, before that", event->name, when)};
    return {Verdict::holds, fmt::format("{} received {}", event->name, when)};
}

ConditionState ConditionWatch::judge_time(const TimeCondition& condition) const {
    if (!prediction_) return {Verdict::not_known, "the time of entry is not known"};
    const Ert from = instant_of(condition.from, *prediction_);
    return {now_ >= from ? Verdict::holds : Verdict::does_not_hold,
            fmt::format("{} is {}", text_of(condition.from), day_of_year_text(from))};
}

}  // namespace aeolis::server::procedures
