// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"

#include <cstddef>
#include <string>

// Where an origin publishes its runs, and its followers read them (docs/scale.md).
namespace aeolis::server::cluster {

inline constexpr const char* run_stream = "AEOLIS_RUNS";        ///< RunRows, in the order of their runs
inline constexpr const char* origin_stream = "AEOLIS_ORIGINS";  ///< the newest OriginState of each
inline constexpr const char* all_runs = "aeolis.runs.>";
inline constexpr const char* all_origins = "aeolis.origins.>";

/// Of one RunRows: an engine takes messages of 1 MB by default.
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

}  // namespace aeolis::server::cluster
