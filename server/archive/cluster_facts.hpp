// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <map>
#include <span>
#include <string>

// What an archive knows of other machines: who it is, whom it follows, how far it is published. Its tables are made
// with the first fact, so that an archive of one machine has none.
namespace aeolis::archive {

/// The archive's own identity: 128 random bits in hexadecimal digits, drawn at the first call.
Result<std::string> cluster_identity(sqlite::Database& database);
/// The identity by which the archive's runs travel: that of the archive that it follows, else its own. Empty: none was
/// drawn yet.
Result<std::string> origin_of_runs(sqlite::Database& database);

/// Facts by name; empty: not known.
inline constexpr char fact_origin[] = "origin";        ///< identity of the archive that this one follows
inline constexpr char fact_taken[] = "taken";          ///< where in the engine's stream the newest step was
inline constexpr char fact_chosen[] = "chosen";        ///< which of its runs are taken; empty: all
inline constexpr char fact_published[] = "published";  ///< which stream of the engine the acknowledged steps are in
Result<std::string> cluster_fact(sqlite::Database& database, const std::string& name);
Result<void> keep_cluster_fact(sqlite::Database& database, const std::string& name, const std::string& value);

/// How much of a run the engine has acknowledged, and the run's state then.
struct PublishedRun {
    RunId run;
    v1::RunPosition position;
    std::string state;
};
Result<std::map<std::uint32_t, PublishedRun>> published_runs(sqlite::Database& database);
/// Call within a transaction. `all`: what is known of other runs is forgotten.
Result<void> keep_published_runs(sqlite::Database& database, std::span<const PublishedRun> runs, bool all);

}  // namespace aeolis::archive
