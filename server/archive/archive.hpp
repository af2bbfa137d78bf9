// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/forecasts.hpp"
#include "server/archive/layouts.hpp"
#include "server/archive/records.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

namespace aeolis::archive {

inline constexpr std::int32_t application_id = 0x41454F31;  ///< "AEO1": identifies the file to file(1) and to Aeolis
inline constexpr std::int32_t schema_version = 1;           ///< PRAGMA user_version

/// The writer of an archive: one SQLite file, many runs, rows only ever added (docs/archive.md).
///
/// In       batches of one run, in the order of their sequence numbers
/// Out      durable rows: after append() returns ok they survive kill -9 and a power cut (WAL, synchronous=FULL)
/// Faults   every disk failure is an Error that names the file. Nothing of that batch is then stored, and the same
///          batch may be given again. A second writer, of this process or another, is refused at open(). A file removed
///          under its name is an Error, once; the next call restores the file as it was
/// Threads  one owner. Readers (reader.hpp) have their own connections
class Archive {
  public:
    /// Opens or creates the file. Refuses, in one line, a file that is not an Aeolis archive, has another schema, or
    /// already has a writer. Marks runs that were cut off as interrupted.
    static Result<Archive> open(const std::filesystem::path& file);

    Archive(Archive&&) noexcept;
    Archive& operator=(Archive&&) noexcept;
    ~Archive();

    /// Begins a run; durable when it returns. Stores the dictionary's words with the first run that uses them.
    Result<RunId> begin_run(const RunStart& start, const dictionary::Dictionary& dictionary);

    /// Continues a run that was cut off; durable when it returns. Fails when the run was not cut off.
    Result<void> continue_run(RunId run);

    /// For each link of a run, the number of octets stored as received, including those removed since.
    Result<std::map<std::string, std::uint64_t>> raw_ends(RunId run);

    /// Stores all of `batch` or none of it; durable when it returns. `batch.end` finishes the run, whose
    /// fingerprint is then in the audit.
    Result<void> append(RunId run, const Batch& batch);

    /// Stores all records or none; durable when it returns.
    Result<void> append_audit(std::span<const AuditRecord> records);
    /// The newest entry of the audit: these records, or the fingerprints of a run that has ended.
    Result<AuditHead> audit_head();
    /// Marks a run that is over as pruned: readers no longer find it; durable when it returns.
    Result<void> prune(RunId run, AuditRecord by);
    /// Removes a piece of what pruned runs left, some milliseconds of work. False: nothing is left (pruning.hpp).
    Result<bool> remove_pruned();
    /// Stores a forecast; durable when it returns. @return its number
    Result<std::uint64_t> keep_forecast(const ForecastRecord& forecast);
    /// Saves or removes a layout of the console; durable when it returns.
    Result<LayoutOutcome> change_layout(const LayoutChange& change);
    /// Adds the last item of a run that is not in progress; durable when it returns. @return the annotation with its
    /// number
    Result<Annotation> annotate(RunId run, Annotation annotation);

    /// The runs that open() found cut off.
    const std::vector<RunId>& interrupted() const;
    const std::filesystem::path& file() const;

  private:
    struct State;
    explicit Archive(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
