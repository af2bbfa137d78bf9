// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"

#include <filesystem>
#include <memory>
#include <vector>

namespace aeolis::archive {

inline constexpr std::int32_t application_id = 0x41454F4C;  ///< "AEOL": what file(1) and we know the file by
inline constexpr std::int32_t schema_version = 1;           ///< PRAGMA user_version

/// The writer of an archive: one SQLite file, many runs, rows only ever added (docs/archive.md).
///
/// In       batches of one run, in the order of their sequence numbers
/// Out      durable rows: when append() returns ok they survive kill -9 and a power cut (WAL, synchronous=FULL)
/// Faults   every failure of the disk is an Error that names the file; nothing of that batch is then stored, and the
///          same batch may be given again. A second writer, of this process or another, is refused at open(). When the
///          file was removed under its name that is an Error, once; the next call puts it back as it was.
/// Threads  one owner. Readers (reader.hpp) have their own connections.
class Archive {
  public:
    /// Opens, or makes, the file. Refuses in one line what is not an Aeolis archive, is of another schema, or has
    /// a writer already. Runs that were cut off are marked interrupted.
    static Result<Archive> open(const std::filesystem::path& file);

    Archive(Archive&&) noexcept;
    Archive& operator=(Archive&&) noexcept;
    ~Archive();

    /// Durable when it returns. The dictionary's words are kept with the first run that uses them.
    Result<RunId> begin_run(const RunStart& start, const dictionary::Dictionary& dictionary);

    /// A run that was cut off goes on: durable when it returns. Fails when it was not.
    Result<void> continue_run(RunId run);

    /// All of `batch` or none of it; durable when it returns. With `batch.end` the run is finished.
    Result<void> append(RunId run, const Batch& batch);

    /// All of it or none, durable when it returns.
    Result<void> append_audit(std::span<const AuditRecord> records);
    /// Adds to a run that does not go on, as its last item; durable when it returns. @return with its number
    Result<Annotation> annotate(RunId run, Annotation annotation);

    /// Runs that open() found cut off.
    const std::vector<RunId>& interrupted() const;
    const std::filesystem::path& file() const;

  private:
    struct State;
    explicit Archive(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
