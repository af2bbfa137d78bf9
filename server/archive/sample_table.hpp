// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace aeolis::archive {

/// Samples as rows of a table `samples` in an SQLite file of their own, for queries in plain SQL: ATTACH it to the
/// archive. A row takes about 60 octets; in the archive a sample takes one or two.
class SampleTable {
  public:
    /// Creates the file. Refuses an existing file.
    static Result<SampleTable> create(const std::filesystem::path& file);

    Result<void> add(RunId run, Sclk entry, const dictionary::Dictionary& dictionary,
                     std::span<const ChannelValue> samples);
    /// Creates the index and keeps the file. Without this call the destructor deletes the file.
    Result<void> finish();

    SampleTable(SampleTable&& other) noexcept;
    SampleTable& operator=(SampleTable&&) = delete;
    ~SampleTable();

  private:
    SampleTable(std::filesystem::path file, sqlite::Database database, sqlite::Statement insert);

    std::filesystem::path file_;  ///< empty: finished, or moved from
    sqlite::Database database_;
    sqlite::Statement insert_;
};

}  // namespace aeolis::archive
