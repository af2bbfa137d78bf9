// SPDX-License-Identifier: Apache-2.0
#include "commands/command_queue.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace aeolis::commands {

void CommandQueue::add(const Entry& entry) {
    const auto place = std::ranges::find_if(entries_, [&](const Entry& each) {
        return each.priority != entry.priority ? each.priority < entry.priority : each.number > entry.number;
    });
    entries_.insert(place, entry);
}

CommandQueue::Entry* CommandQueue::find(std::uint64_t number) {
    const auto found = std::ranges::find(entries_, number, &Entry::number);
    return found == entries_.end() ? nullptr : &*found;
}

bool CommandQueue::set_held(std::uint64_t number, bool held) {
    auto* const entry = find(number);
    if (entry != nullptr) entry->held = held;
    return entry != nullptr;
}

bool CommandQueue::cancel(std::uint64_t number) {
    return std::erase_if(entries_, [&](const Entry& each) { return each.number == number; }) > 0;
}

bool CommandQueue::approve(std::uint64_t number) {
    auto* const entry = find(number);
    return entry != nullptr && std::exchange(entry->needs_approval, false);
}

std::vector<std::uint64_t> CommandQueue::doubt_after(std::uint64_t number) {
    std::vector<std::uint64_t> doubted;
    for (Entry& each : entries_) {
        if (!each.in_order || each.number <= number) continue;
        each.doubted = true;
        doubted.push_back(each.number);
    }
    return doubted;
}

bool CommandQueue::judged(std::uint64_t number) {
    auto* const entry = find(number);
    return entry != nullptr && std::exchange(entry->doubted, false);
}

std::optional<std::uint64_t> CommandQueue::leaves_after(const Entry& entry) const {
    std::optional<std::uint64_t> last;
    if (!entry.in_order) return last;
    for (const Entry& each : entries_)
        if (each.in_order && each.number < entry.number) last = std::max(last.value_or(0), each.number);
    return last;
}

bool CommandQueue::is_due(const Entry& entry, Ert now) const {
    return !entry.held && !entry.needs_approval && !entry.doubted && (!entry.release_at || *entry.release_at <= now) &&
           !leaves_after(entry);
}

bool CommandQueue::due(std::uint64_t number, Ert now) const {
    const auto found = std::ranges::find(entries_, number, &Entry::number);
    return found != entries_.end() && is_due(*found, now);
}

std::vector<std::uint64_t> CommandQueue::take_all() {
    std::vector<std::uint64_t> all;
    for (const Entry& each : std::exchange(entries_, {})) all.push_back(each.number);
    return all;
}

bool CommandQueue::any_due(Ert now) const {
    return std::ranges::any_of(entries_, [&](const Entry& each) { return is_due(each, now); });
}

std::optional<std::uint64_t> CommandQueue::take_next(Ert now, Precedence least) {
    const bool is_others_turn = directors_in_a_row_ >= directors_in_a_row_max;
    if (std::ranges::none_of(entries_, [&](const Entry& each) { return each.precedence >= least; })) return {};
    std::set<std::string_view> seen;  // an asker's first due command is the one to compare
    const auto rank = [&](const Entry& entry) {
        const auto turn = last_turn_.find(entry.asker);
        return std::tuple{entry.precedence != Precedence::hazardous,
                          (entry.precedence == Precedence::director) == is_others_turn,
                          turn == last_turn_.end() ? 0 : turn->second, ~entry.priority, entry.number};
    };
    auto next = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
        if (seen.contains(entry->asker) || !is_due(*entry, now)) continue;
        seen.insert(entry->asker);
        if (next == entries_.end() || rank(*entry) < rank(*next)) next = entry;
    }
    if (next == entries_.end() || next->precedence < least) return {};
    const Entry taken = *next;
    entries_.erase(next);
    // Kept when none of the asker's waits any more: whoever asks for one at a time does not begin anew each time.
    last_turn_[taken.asker] = ++turns_;
    if (last_turn_.size() > askers_max)
        last_turn_.erase(std::ranges::min_element(last_turn_, {}, [](const auto& each) { return each.second; }));
    if (taken.precedence == Precedence::director)
        ++directors_in_a_row_;
    else if (taken.precedence == Precedence::ordinary)
        directors_in_a_row_ = 0;
    return taken.number;
}

std::vector<std::uint64_t> CommandQueue::postpone_due(Ert now, Ert until) {
    std::vector<std::uint64_t> postponed;
    for (Entry& each : entries_) {
        if (!is_due(each, now)) continue;
        each.release_at = until;
        postponed.push_back(each.number);
    }
    return postponed;
}

}  // namespace aeolis::commands
