// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// The latest value of a channel that ground has received.
struct LatestValue {
    std::optional<double> value;  ///< none: never received, or undefined on board
    double age_s = 0.0;           ///< since its receipt, without the light time
};

/// A value older than this is not current. Our assumption: thirty missed samples of a 1 Hz channel.
inline constexpr double stale_after_s = 30.0;

struct PreconditionReply {
    enum class Verdict { holds, fails, unknown };
    Verdict verdict = Verdict::unknown;
    std::optional<double> value;
    std::string text;  ///< such as "parameters_received == 1: is 0", "late_cruise == 1: not received yet"
};

/// "holds", "fails", "unknown"
const char* name_of(PreconditionReply::Verdict verdict);

/// Checks each transmission constraint of the command against the latest values, which are indexed by ChannelId.
std::vector<PreconditionReply> check(const dictionary::Dictionary& dictionary, const dictionary::Command& command,
                                     std::span<const LatestValue> latest);

}  // namespace aeolis::commands
