#pragma once

#include "dictionaries/dictionary.hpp"

#include <optional>
#include <vector>

namespace aeolis::archive {

/// When each timepoint would fire if nothing but the plan decided, in seconds from the anchor `entry`; none where that
/// depends on what happens in flight. By the rule of R11: the desired offset has come, and so has the minimum offset
/// from the previous firing.
std::vector<std::optional<double>> planned_from_entry_s(const dictionary::Dictionary& dictionary);

} // namespace aeolis::archive
