// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

// The rows of a run as an archive of another server takes them: read here after their commit, written there as they
// are. docs/decisions/0042.
namespace aeolis::archive {

/// A run as its archive knows it.
struct RunHead {
    RunId run;
    std::string state;  ///< "running", "finished", "interrupted"
    Sequence last_seq = 0;
    std::uint16_t dictionary = 0;
};

/// Rows of one run that were committed, and what they bring its copy to.
struct RunStep {
    std::uint16_t dictionary = 0;  ///< of the run
    v1::RunPosition before, after;
    v1::RowSet rows;
};

/// How much of a run an archive holds.
Result<v1::RunPosition> position_of(sqlite::Database& database, RunId run);
/// Whether all of `part` is in `whole`.
bool within(const v1::RunPosition& part, const v1::RunPosition& whole);
/// Whether both are the same. Their messages' octets may differ: a map has no order.
bool equal(const v1::RunPosition& one, const v1::RunPosition& other);
/// The farther of both, part by part.
v1::RunPosition merged(const v1::RunPosition& one, const v1::RunPosition& other);
/// Digest of the definitions of the tables of runs: archives with the same one take each other's rows.
Result<std::string> tables_digest(sqlite::Database& database);

/// A RowSet as octets, packed; and from them. The Error: they are none, or hold more than row_set_octets_max.
inline constexpr std::size_t row_set_octets_max = 64U << 20U;
std::string packed(const v1::RowSet& rows);
Result<v1::RowSet> unpacked(const std::string& octets);

/// Reads runs step by step, as they are committed. One thread owns it; the writer proceeds meanwhile.
///
/// Memory   a step: about items_max items or octets_max octets, whichever is less, and one row more
class RunRowsReader {
  public:
    static constexpr Sequence items_max = 8192;             ///< of a step; as many as wait for a commit at most
    static constexpr std::size_t octets_max = 768U << 10U;  ///< chosen: two messages of an engine's default limit

    static Result<RunRowsReader> open(const std::filesystem::path& file);
    RunRowsReader(RunRowsReader&&) noexcept;
    RunRowsReader& operator=(RunRowsReader&&) noexcept;
    ~RunRowsReader();

    /// Whether something was committed since the last call. The first time: true.
    Result<bool> changed();
    /// The largest number of a run; 0: there is none.
    Result<std::uint32_t> newest_run();
    /// All runs, the newest first.
    Result<std::vector<RunHead>> runs();
    Result<std::optional<RunHead>> run(RunId run);
    const std::string& tables() const;
    Result<std::string> origin();  ///< origin_of_runs()

    /// What was committed behind `before`, as far as a step goes. None: nothing, or only counters and `counters` is
    /// false.
    Result<std::optional<RunStep>> next(RunId run, const v1::RunPosition& before, bool counters);
    /// Steps that next() gave may not have arrived: rows that change are given again.
    void forget(RunId run);

  private:
    struct State;
    explicit RunRowsReader(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Writes steps. Its owner begins and commits the transaction.
class RunRowsWriter {
  public:
    explicit RunRowsWriter(sqlite::Database& database) : database_(&database) {}

    /// What became of a step.
    struct Taken {
        Sequence first = 0, last = 0;  ///< items that are new; both 0: none
        bool ended = false;            ///< the run is over, as it now stands
    };
    /// Writes what is not there yet. The Error: it is not of this run, leaves out a number or holds one twice.
    Result<Taken> take(RunId run, const RunStep& step);

  private:
    Result<void> write(RunId run, const RunStep& step, const v1::TableRows& rows);
    Result<void> check_items(RunId run, Sequence first, Sequence last);
    Result<sqlite::Statement*> statement(const std::string& sql);

    sqlite::Database* database_;
    std::map<std::string, sqlite::Statement> statements_;
};

}  // namespace aeolis::archive
