// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/link_counters.hpp"

#include <cstddef>
#include <map>

namespace aeolis::telemetry {

/// Sequences of a link that are counted by name; chosen. Only damaged or random headers make more.
inline constexpr std::size_t sequences_named_max = 4096;
/// Name of the row of all others.
inline constexpr char other_sequences[] = "others";

/// Counters of sequences by key: a row for each of the first `sequences_named_max` keys, and one for all others
/// together. No row is ever dropped, so that no total falls.
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
