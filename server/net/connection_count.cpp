// SPDX-License-Identifier: Apache-2.0
#include "server/net/connection_count.hpp"

#include "commands/shares.hpp"
#include "common/check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server {
namespace {

void take_from(std::map<std::string, std::size_t>& counts, const std::string& key) {
    const auto found = counts.find(key);
    if (--found->second == 0) counts.erase(found);
}

}  // namespace

Result<std::shared_ptr<ConnectionCount::Place>> ConnectionCount::enter(const std::string& network, bool shared,
                                                                       std::function<void()> close) {
    const auto own = strangers_of_.find(network);
    const bool own_full = !shared && own != strangers_of_.end() && own->second >= limits_.strangers_of_network;
    if (own_full) close_oldest_of(network);
    const bool full = entries_.size() >= limits_.all || strangers_ >= limits_.strangers;
    if (full && !own_full && !make_room())
        return Error{fmt::format("{} connections are open already", entries_.size())};
    entries_.push_back({network, {}, false, std::move(close)});
    ++strangers_;
    ++strangers_of_[network];
    return std::make_shared<Place>(*this, std::prev(entries_.end()));
}

bool ConnectionCount::make_room() {
    if (strangers_of_.empty()) return false;
    const auto most = std::ranges::max_element(strangers_of_, {}, [](const auto& each) { return each.second; });
    close_oldest_of(std::string{most->first});
    return true;
}

void ConnectionCount::close_oldest_of(const std::string& network) {
    const auto oldest = std::ranges::find_if(
        entries_, [&](const Entry& entry) { return !entry.known && entry.close && entry.network == network; });
    AEOLIS_CHECK(oldest != entries_.end());  // the network has strangers
    forget_stranger(*oldest);
    std::exchange(oldest->close, nullptr)();
}

void ConnectionCount::forget_stranger(const Entry& entry) {
    --strangers_;
    take_from(strangers_of_, entry.network);
}

Result<void> ConnectionCount::know(Entry& entry, const std::string& person) {
    if (entry.known) return {};
    const auto own = places_of_.find(person);
    const auto mine = own == places_of_.end() ? std::size_t{0} : own->second;
    if (!person.empty() && !commands::may_take(mine, entries_.size() - strangers_, limits_.all))
        return Error{fmt::format("{} connections of {} are open already, no more than are free", mine, person)};
    if (entry.close) forget_stranger(entry);  // else it is being closed
    entry.known = true;
    if (person.empty()) return {};
    entry.person = person;
    ++places_of_[person];
    return {};
}

void ConnectionCount::leave(std::list<Entry>::iterator entry) {
    if (!entry->known && entry->close) forget_stranger(*entry);
    if (!entry->person.empty()) take_from(places_of_, entry->person);
    entries_.erase(entry);
}

}  // namespace aeolis::server
