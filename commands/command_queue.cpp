#include "commands/command_queue.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::commands {

void CommandQueue::add(const Entry& entry) {
    const auto place = std::ranges::find_if(entries_, [&](const Entry& each) { return each.priority < entry.priority; });
    entries_.insert(place, entry);
}

bool CommandQueue::set_held(std::uint64_t number, bool held) {
    const auto found = std::ranges::find(entries_, number, &Entry::number);
    if (found == entries_.end()) return false;
    found->held = held;
    return true;
}

bool CommandQueue::cancel(std::uint64_t number) {
    return std::erase_if(entries_, [&](const Entry& each) { return each.number == number; }) > 0;
}

bool CommandQueue::approve(std::uint64_t number) {
    const auto found = std::ranges::find(entries_, number, &Entry::number);
    if (found == entries_.end()) return false;
    return std::exchange(found->needs_approval, false);
}

std::vector<std::uint64_t> CommandQueue::take_due(Ert now) {
    std::vector<std::uint64_t> due;
    for (const Entry& each : entries_)
        if (is_due(each, now)) due.push_back(each.number);
    std::erase_if(entries_, [&](const Entry& each) { return is_due(each, now); });
    return due;
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

} // namespace aeolis::commands
