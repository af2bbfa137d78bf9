// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <optional>
#include <vector>

namespace aeolis::dictionary {

/// When each timepoint would fire if nothing but the plan decided, in seconds from the anchor `entry`; none where that
/// depends on what happens in flight. By the rule of R11: the desired offset has come, and so has the minimum offset
/// from the previous firing.
std::vector<std::optional<double>> planned_from_entry_s(const Dictionary& dictionary);

/// When each timepoint is predicted, as ground has it at entry interface, in seconds from the entry that was predicted
/// at the start: by the same rule over the anchors of the plan, moved by what was heard until then, and after entry
/// over those of the design (predicted_anchors.csv), moved along with the one before. None where nobody predicts its
/// anchor.
///
/// @param design_e_s  by anchor: when it comes in the design, as the sheet had it when the run began
/// @param heard_e_s  by timepoint: when it fired, as far as ground had heard of it; what has fired stands as it was
///   predicted before its own anchor was heard of
std::vector<std::optional<double>> predicted_from_entry_s(const Dictionary& dictionary,
                                                          const std::vector<std::optional<double>>& design_e_s,
                                                          const std::vector<std::optional<double>>& heard_e_s);

}  // namespace aeolis::dictionary
