// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/cluster_facts.hpp"
#include "server/archive/run_rows.hpp"
#include "server/archive/sqlite.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

namespace aeolis::archive {

/// What an archive has to do with other machines: who it is, whom it follows, and the rows that it takes from there
/// (docs/decisions/0042).
///
/// It is a connection of its own, beside that of the archive's writer, which must be open in the same process and
/// excludes other programs. Each writes whole transactions, and waits for the other's.
///
/// Faults   as Archive: every disk failure is an internal Error that names the file, and nothing of the call is stored
/// Threads  one owner
class SharedArchive {
  public:
    static Result<SharedArchive> open(const std::filesystem::path& file);

    /// Who this archive is, drawn at the first call.
    Result<std::string> identity();
    /// The identity of the archive that this one follows; empty: none.
    Result<std::string> followed();
    /// Follows an archive from now on. Refused while this one has runs, unless it is a copy of that archive or follows
    /// it already.
    Result<void> follow(const std::string& origin);
    /// Becomes an archive of its own, with all it holds. Open its writer anew: runs that go on in the origin are cut
    /// off here.
    Result<void> stop_following();
    Result<std::string> fact(const std::string& name);
    Result<void> keep_fact(const std::string& name, const std::string& value);
    Result<std::string> tables();  ///< tables_digest()

    Result<std::map<std::uint32_t, PublishedRun>> published();
    /// @param stream  in which they are acknowledged; runs of another stream are forgotten
    Result<void> keep_published(std::span<const PublishedRun> runs, const std::string& stream);

    /// How much of a run is here.
    Result<v1::RunPosition> position(RunId run);
    /// Whether nothing is to be fetched of a run that has items up to `last` elsewhere: it is over and has them here, or
    /// it was pruned here.
    Result<bool> is_settled(RunId run, Sequence last);
    struct Items {
        Sequence first = 0, last = 0;  ///< both 0: none
    };
    /// Writes a step of the archive that this one follows, all of it or none; durable when it returns. A run that was
    /// pruned here is passed over. Where a run ends, its rows must give the fingerprint that its origin's audit has.
    /// @param place  in the engine's stream, kept as fact_taken
    /// @return the items that are new. An Error that is not internal is the step's own
    Result<Items> take(RunId run, const RunStep& step, const std::string& place);

  private:
    explicit SharedArchive(std::unique_ptr<sqlite::Database> database);
    /// Opens the file again where the writer put it back under its name.
    Result<void> in_place();
    Result<void> add_fingerprint(RunId run, Sequence first, Sequence last);
    Result<void> add_fingerprint_of_end(RunId run, const RunStep& step, bool ended_before, const Items& added);

    std::unique_ptr<sqlite::Database> database_;
    RunRowsWriter rows_;  // before database_
};

}  // namespace aeolis::archive
