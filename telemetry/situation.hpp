// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace aeolis::telemetry {

/// The order of importance; numbers equal those of the schema. A lost connection ranks above them all; only a client
/// knows of it.
enum class SituationRank : std::uint8_t {
    lasting,  ///< a state that goes on
    calm,
    waiting,  ///< for the next step
    silence,  ///< as predicted
    news,     ///< what changed, until a reader puts it aside or something follows it
    danger,   ///< to the vehicle
};
inline constexpr std::size_t situation_ranks = 6;
const char* name_of(SituationRank rank);

/// One thing that is true, in words, with its evidence.
struct SituationEntry {
    SituationRank rank{};
    std::string subject;             ///< "computer", "uhf_live", "command 3"; unique within a rank
    std::string sentence;            ///< contains no running time
    std::string evidence;            ///< in words
    std::uint64_t evidence_seq = 0;  ///< the item that it rests on; 0: a prediction alone
    Ert since;                       ///< since when it is so
    std::string awaited;             ///< what is counted down to; empty: nothing
    std::optional<Ert> at{};         ///< when that can be received, as predicted
    bool overdue = false;            ///< it should have been received by now
    std::string timepoint{};         ///< the step that it is about; empty: about none
    bool operator==(const SituationEntry&) const = default;
};

}  // namespace aeolis::telemetry
