// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"
#include "telemetry/alarm_register.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/staleness.hpp"

#include <algorithm>

// The states of alarms, derived anew for each query from the changes and actions.
namespace aeolis::archive {

namespace {

const std::string& name_of_alarm(const v1::Item& item, const dictionary::Dictionary& dictionary) {
    if (item.has_alarm()) return dictionary.channels[item.alarm().channel()].name;
    if (item.has_link()) return item.link().link();
    return item.has_staleness() ? item.staleness().packet() : item.alarm_action().alarm();
}

void apply(const v1::Item& item, const dictionary::Dictionary& dictionary, telemetry::AlarmRegister& entries) {
    using dictionary::Severity;
    const std::string& name = name_of_alarm(item, dictionary);
    if (item.has_alarm()) {
        const auto& alarms = dictionary.channels[item.alarm().channel()].type.alarms;
        entries.change(name, static_cast<Severity>(item.alarm().severity()), telemetry::latches(alarms));
    } else if (item.has_staleness()) {
        entries.change(name, item.staleness().missing() ? telemetry::stale_severity : Severity::none, false);
    } else if (item.has_link()) {
        entries.change(name, item.link().lost() ? telemetry::lost_severity : Severity::none, false);
    } else {
        entries.act(name, static_cast<telemetry::AlarmAct>(item.alarm_action().action()), Ert{item.ert_us()},
                    Ert{item.alarm_action().until_us()});
    }
}

/// Sets the parts of an alarm's state that the last item of each kind gives.
void describe(const v1::Item& item, v1::AlarmState& state) {
    state.set_seq(item.seq());
    if (item.has_alarm()) {
        state.set_kind(v1::StandingAlarm::limit);
        if (!item.alarm().limit().empty()) state.set_limit(item.alarm().limit());
        state.set_value(item.alarm().value());
        state.set_sclk(item.alarm().sclk());
    } else if (item.has_staleness()) {
        state.set_kind(v1::StandingAlarm::staleness);
        state.set_value(item.staleness().silent_s());
        state.set_reason(item.staleness().reason());
    } else if (item.has_link()) {
        state.set_kind(v1::StandingAlarm::link);
        state.set_reason(item.link().reason());
    } else {
        state.set_by(item.alarm_action().by());
        state.set_note(item.alarm_action().note());
    }
}

/// Names for each missing packet the lost link for which it is missing.
void name_causes(std::vector<v1::AlarmState>& states) {
    const auto stands = [](const v1::AlarmState& state) { return state.severity() != v1::Alarm::none; };
    for (auto& packet : states) {
        if (packet.kind() != v1::StandingAlarm::staleness || !stands(packet)) continue;
        const auto link = std::ranges::find_if(states, [&](const v1::AlarmState& state) {
            return state.kind() == v1::StandingAlarm::link && stands(state) &&
                   telemetry::names_lost_link(packet.reason(), state.reason());
        });
        if (link != states.end()) packet.set_cause(link->name());
    }
}

}  // namespace

/// All changes and actions of the run's alarms, and the states that result.
Result<telemetry::AlarmRegister> Reader::alarm_register(RunId run, std::vector<v1::Item>& changes) {
    {
        const auto info = state_->info(run);
        if (!info) return info.error();
        if (auto same = state_->same_dictionary(*info); !same) return same.error();
    }
    telemetry::AlarmRegister entries;
    for (Sequence after = 0;;) {
        auto page = alarms(run, after, rows_page_max);
        if (!page) return page.error();
        for (auto& item : *page->mutable_changes()) {
            apply(item, state_->dictionary, entries);
            changes.push_back(std::move(item));
        }
        after = page->next_after();
        if (after == 0) return entries;
    }
}

Result<v1::AlarmList> Reader::alarm_states(RunId run, std::optional<Ert> now) {
    std::vector<v1::Item> changes;
    const auto entries = alarm_register(run, changes);
    if (!entries) return entries.error();
    const auto newest = newest_ert(run);
    if (!newest) return newest.error();
    const Ert at = now.value_or(*newest);

    std::map<std::string, v1::AlarmState> described;
    for (const auto& item : changes) describe(item, described[name_of_alarm(item, state_->dictionary)]);
    std::vector<v1::AlarmState> states;
    for (const auto& [name, state] : entries->all()) {
        const auto standing = state.standing(at);
        if (standing == telemetry::AlarmStanding::normal) continue;
        auto& written = states.emplace_back(std::move(described[name]));
        written.set_name(name);
        if (!written.has_kind())
            written.set_kind(state_->dictionary.channel(name) != nullptr  ? v1::StandingAlarm::limit
                             : state_->dictionary.packet(name) != nullptr ? v1::StandingAlarm::staleness
                                                                          : v1::StandingAlarm::link);
        written.set_state(static_cast<v1::StandingAlarm::State>(standing));
        written.set_severity(static_cast<v1::Alarm::Severity>(state.severity));
        written.set_worst(static_cast<v1::Alarm::Severity>(state.worst));
        written.set_acknowledged(state.acknowledged);
        written.set_latches(state.latches);
        if (state.shelved_until && at < *state.shelved_until)
            written.set_shelved_until_us(state.shelved_until->microseconds);
    }
    name_causes(states);
    std::ranges::stable_sort(states, std::ranges::greater{},
                             [](const v1::AlarmState& state) { return state.severity(); });
    v1::AlarmList list;
    for (auto& state : states) *list.add_alarms() = std::move(state);
    return list;
}

Result<std::vector<std::string>> Reader::links() {
    auto rows = state_->query("SELECT word FROM words WHERE kind = 'link' ORDER BY number");
    if (!rows) return rows.error();
    std::vector<std::string> names;
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return names;
        names.emplace_back((*rows)->text(0));
    }
}

Result<void> Reader::may(RunId run, const std::string& alarm, telemetry::AlarmAct act, Ert now) {
    std::vector<v1::Item> changes;
    const auto entries = alarm_register(run, changes);
    if (!entries) return entries.error();
    return entries->may(alarm, act, now);
}

Result<Ert> Reader::newest_ert(RunId run) {
    auto rows = state_->query("SELECT ert_us FROM packets WHERE key BETWEEN ?1 AND ?2 ORDER BY key DESC LIMIT 1");
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    auto found = (*rows)->step();
    if (!found) return found.error();
    return *found ? Ert{(*rows)->integer(0)} : Ert{};
}

}  // namespace aeolis::archive
