// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include <iterator>
#include <vector>

namespace aeolis::pipeline {

/// Calls take(record) for the records behind the item `followed`, in their order.
template <typename Record>
void each_new(const std::vector<Record>& records, archive::Sequence followed, auto take) {
    auto first = records.end();
    while (first != records.begin() && std::prev(first)->seq > followed) --first;
    for (; first != records.end(); ++first) take(*first);
}

}  // namespace aeolis::pipeline
