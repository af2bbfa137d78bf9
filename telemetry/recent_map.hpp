// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <cstddef>
#include <list>
#include <map>

namespace aeolis::telemetry {

/// At most `most` values by key. Adding one more forgets the value that was requested longest ago.
template <typename Key, typename Value>
class RecentMap {
  public:
    explicit RecentMap(std::size_t most) : most_(most) { AEOLIS_CHECK(most > 0); }
    RecentMap(RecentMap&&) = default;
    RecentMap& operator=(RecentMap&&) = default;

    /// The value of `key`; a new one when there is none. `forget(key, value)` is called before a value is forgotten.
    template <typename Forget>
    Value& at(const Key& key, Forget forget) {
        auto found = values_.find(key);
        if (found == values_.end()) {
            if (values_.size() == most_) {
                const auto oldest = values_.find(order_.front());
                forget(oldest->first, oldest->second.value);
                values_.erase(oldest);
                order_.pop_front();
            }
            found = values_.try_emplace(key).first;
            found->second.place = order_.insert(order_.end(), key);
        }
        order_.splice(order_.end(), order_, found->second.place);
        return found->second.value;
    }
    /// Calls `use(key, value)` for each, by key.
    template <typename Use>
    void each(Use use) const {
        for (const auto& [key, entry] : values_) use(key, entry.value);
    }
    template <typename Use>
    void each(Use use) {
        for (auto& [key, entry] : values_) use(key, entry.value);
    }
    std::size_t size() const { return values_.size(); }

  private:
    struct Entry {
        Value value{};
        std::list<Key>::iterator place{};
    };
    std::size_t most_;
    std::list<Key> order_;  ///< the one asked for longest ago first
    std::map<Key, Entry> values_;
};

}  // namespace aeolis::telemetry
