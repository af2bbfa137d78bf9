// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::telemetry {

struct Condition {
    std::string quantity;  ///< "speed_mps"
    double value = 0.0;
    std::string comparison;  ///< "<", "<=", "==", ">=", ">"
    double bound = 0.0;
    bool holds = false;  ///< as flight found it; ground does not judge again
};

/// A decision of the flight software and the conditions that led to it, in words. R38
struct Explanation {
    std::string text;  ///< "parachute_deploy fired: speed 404.6 m/s <= 405.0 m/s"
    std::string decision, verdict;
    std::string subject;  ///< name of the timepoint, command or tone that it is about; may be empty
    std::vector<Condition> conditions;
    std::uint32_t suppressed = 0;  ///< held just so, in as many cycles, and not told: flight's flood limit
};

/// Of the packet named "Explanation", else none.
///
/// The packet's fields: decision, verdict, subject, condition_count, then for each slot k from 1 to 4: condition_k (the
/// quantity), value_k, bound_k, comparison_k (lt, le, eq, ge, gt), holds_k; and suppressed. A condition that does not
/// hold is told by what holds instead: "speed 407.1 m/s > 405.0 m/s". `subject` is the number of a timepoint, a tone, a
/// bank reversal, an opcode or the new value of a channel, as the decision's label says; of other decisions the label
/// is enough.
std::optional<Explanation> explain(const dictionary::Dictionary& dictionary, const Decoded& decoded);

}  // namespace aeolis::telemetry
