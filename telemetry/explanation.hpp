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
    bool holds = false;  ///< as flight judged it; ground does not judge again
};

/// A decision of the flight software with its conditions, in words. R38
struct Explanation {
    std::string text;  ///< "parachute deploy decided: speed 404.6 m/s <= 405.0 m/s"
    std::string decision, verdict;
    std::string subject;  ///< name of the timepoint, command or tone concerned; may be empty
    std::vector<Condition> conditions;
    std::uint32_t suppressed = 0;  ///< cycles with the same hold that were not reported: flight's flood limit
};

/// Returns the explanation in a packet named "Explanation"; none for other packets.
///
/// The packet's fields: decision, verdict, subject, condition_count, then for each slot k from 1 to 4: condition_k (the
/// quantity), value_k, bound_k, comparison_k (lt, le, eq, ge, gt), holds_k; and suppressed. The text of a condition
/// that does not hold states the opposite: "speed 407.1 m/s > 405.0 m/s". A fact reads "parameters received: yes". The
/// decision's label says what number `subject` is: a timepoint, a tone, a bank reversal, an opcode or a field's new
/// value; other decisions need no subject.
std::optional<Explanation> explain(const dictionary::Dictionary& dictionary, const Decoded& decoded);

}  // namespace aeolis::telemetry
