// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace aeolis::telemetry {

/// Values by key, `most` at most: of more, the one that was asked for longest ago is forgotten.
template <typename Key, typename Value>
class RecentMap {
  public:
    explicit RecentMap(std::size_t most) : most_(most) { AEOLIS_CHECK(most > 0); }

    /// The value of `key`; a new one when there is none. `forget(Value&)` is called before a value is forgotten.
    template <typename Forget>
    Value& at(const Key& key, Forget forget) {
        auto found = values_.find(key);
        if (found == values_.end()) {
            if (values_.size() == most_) {
                const auto oldest =
                    std::ranges::min_element(values_, {}, [](const auto& each) { return each.second.asked; });
                forget(oldest->second.value);
                values_.erase(oldest);
            }
            found = values_.try_emplace(key).first;
        }
        found->second.asked = ++asked_;
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
        std::uint64_t asked = 0;
    };
    std::size_t most_;
    std::uint64_t asked_ = 0;
    std::map<Key, Entry> values_;
};

}  // namespace aeolis::telemetry
