// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"

#include <cstddef>
#include <map>

namespace aeolis::telemetry {

/// Chosen: sequences of a link told by name. More are made only by damaged or random headers.
inline constexpr std::size_t sequences_named_max = 4096;
/// Name of the row of all others.
inline constexpr char other_sequences[] = "others";

/// Counters of sequences by key: of the first `sequences_named_max` keys each its own, of all others together one row.
/// None is ever dropped, so that no total falls.
template <typename Key>
class SequenceTable {
  public:
    SequenceCounters& of(const Key& key) {
        const auto found = rows_.find(key);
        if (found != rows_.end()) return found->second;
        if (rows_.size() < sequences_named_max) return rows_[key];
        return others_;
    }
    const std::map<Key, SequenceCounters>& rows() const { return rows_; }
    const SequenceCounters& others() const { return others_; }

  private:
    std::map<Key, SequenceCounters> rows_;
    SequenceCounters others_;
};

}  // namespace aeolis::telemetry
