// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/archive/run_rows.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// How a run travels from its origin to followers: where an engine keeps it, and the messages of its steps
// (docs/scale.md).
namespace aeolis::server::cluster {

inline constexpr const char* run_stream = "AEOLIS_RUNS";        ///< RunRows, in the order of their runs
inline constexpr const char* origin_stream = "AEOLIS_ORIGINS";  ///< the newest OriginState of each
inline constexpr const char* all_runs = "aeolis.runs.>";
inline constexpr const char* all_origins = "aeolis.origins.>";

/// Of the rows in one RunRows: an engine takes messages of 1 MB by default.
inline constexpr std::size_t piece_octets_max = 512U << 10U;

inline std::string subject_of_origin(const std::string& archive) {
    return "aeolis.origins." + archive;
}
inline std::string subject_of_runs(const std::string& archive) {
    return "aeolis.runs." + archive + ".*";
}
inline std::string subject_of_run(const std::string& archive, archive::RunId run) {
    return "aeolis.runs." + archive + "." + std::to_string(run.value);
}
/// Where the people of followers ask; no stream keeps it.
inline std::string subject_of_requests(const std::string& archive) {
    return "aeolis.requests." + archive;
}
/// As much of an identity as a sentence needs.
inline std::string brief(const std::string& archive) {
    constexpr std::size_t digits = 8;
    return archive.substr(0, digits);
}

/// The messages of a step, in their order: RunRows, encoded, each with at most piece_octets_max of its rows.
/// @param head  says whose run it is: archive, publisher, run, tables
std::vector<std::string> messages_of(const archive::RunStep& step, v1::RunRows head);

/// A message as an engine or a server gave it. The Error: it is none of an origin.
Result<v1::RunRows> run_rows_of(std::string_view octets);

/// A step as its messages bring it.
struct TravelledStep {
    v1::RunRows head;    ///< of its first message, without octets
    std::string octets;  ///< of its rows, packed
};

/// Joins the messages of steps again, of each run by itself.
///
/// Memory   a step of each run of which one has begun: row_set_octets_max at most
class StepJoiner {
  public:
    /// The step that this message completes; none: more of it is to come. The Error: the one before it is missing, or
    /// the step is too large; what came of it is forgotten.
    Result<std::optional<TravelledStep>> join(v1::RunRows message);
    void forget() { begun_.clear(); }

  private:
    struct Begun {
        TravelledStep step;
        std::uint32_t next = 0;
    };
    std::map<std::uint32_t, Begun> begun_;
};

}  // namespace aeolis::server::cluster
