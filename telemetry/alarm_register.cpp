// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarm_register.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace aeolis::telemetry {
namespace {

using dictionary::Severity;

constexpr std::array act_words{std::pair{AlarmAct::acknowledge, "acknowledge"}, std::pair{AlarmAct::shelve, "shelve"},
                               std::pair{AlarmAct::unshelve, "unshelve"}, std::pair{AlarmAct::reset, "reset"}};

bool is_shelved(const AlarmState& state, Ert now) {
    return state.shelved_until && now < *state.shelved_until;
}

/// Ends an alarm that is within limits and needs no further action.
void settle(AlarmState& state) {
    if (state.severity != Severity::none || state.latches || !state.acknowledged) return;
    state.worst = Severity::none;
    state.acknowledged = false;
}

}  // namespace

const char* name_of(AlarmAct act) {
    for (const auto& [each, word] : act_words)
        if (each == act) return word;
    return "";
}

std::optional<AlarmAct> alarm_act(std::string_view word) {
    for (const auto& [act, each] : act_words)
        if (each == word) return act;
    return {};
}

const char* name_of(AlarmStanding standing) {
    constexpr std::array names{"normal", "unacknowledged", "acknowledged", "returned", "latched", "shelved"};
    return names[static_cast<std::size_t>(standing)];
}

AlarmStanding AlarmState::standing(Ert now) const {
    if (is_shelved(*this, now)) return AlarmStanding::shelved;
    if (normal()) return AlarmStanding::normal;
    if (severity != Severity::none) return acknowledged ? AlarmStanding::acknowledged : AlarmStanding::unacknowledged;
    return latches ? AlarmStanding::latched : AlarmStanding::returned;
}

void AlarmRegister::change(std::string_view name, Severity severity, bool latches) {
    if (severity == Severity::none && !states_.contains(name)) return;
    AlarmState& state = states_[std::string(name)];
    const bool came_again = state.severity == Severity::none && severity != Severity::none;
    if (came_again || severity > state.worst) state.acknowledged = false;
    state.severity = severity;
    state.worst = std::max(state.worst, severity);
    state.latches = latches;
    settle(state);
}

Result<void> AlarmRegister::may(std::string_view name, AlarmAct act, Ert now) const {
    const std::string who = "alarm " + std::string(name);
    const auto found = states_.find(name);
    const AlarmState state = found == states_.end() ? AlarmState{} : found->second;
    switch (act) {
    case AlarmAct::acknowledge:
        if (state.normal()) return Error{who + " is normal: there is nothing to acknowledge"};
        if (state.acknowledged) return Error{who + " has been acknowledged already"};
        return {};
    case AlarmAct::shelve: return {};
    case AlarmAct::unshelve:
        if (!is_shelved(state, now)) return Error{who + " is not shelved"};
        return {};
    case AlarmAct::reset:
        if (state.normal() || !state.latches) return Error{who + " is not latched: there is nothing to reset"};
        if (state.severity != Severity::none)
            return Error{who + " still stands: it can be reset when its cause is gone"};
        if (!state.acknowledged) return Error{who + " is not acknowledged: acknowledge it first"};
        return {};
    }
    return Error{"no such act"};
}

void AlarmRegister::act(std::string_view name, AlarmAct act, Ert now, Ert until) {
    if (!may(name, act, now)) return;
    AlarmState& state = states_[std::string(name)];
    switch (act) {
    case AlarmAct::acknowledge: state.acknowledged = true; return settle(state);
    case AlarmAct::shelve: state.shelved_until = until; return;
    case AlarmAct::unshelve: state.shelved_until.reset(); return;
    case AlarmAct::reset:
        state.worst = Severity::none;
        state.acknowledged = false;
        return;
    }
}

}  // namespace aeolis::telemetry
