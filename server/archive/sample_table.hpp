// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace aeolis::archive {

/// Samples as rows of a table `samples` in an SQLite file of their own, for questions in plain SQL: ATTACH it to the
/// archive. A row is some 60 octets where the archive needs one or two.
class SampleTable {
  public:
    /// Refuses a file that is there already.
    static Result<SampleTable> create(const std::filesystem::path& file);

    Result<void> add(RunId run, Sclk entry, const dictionary::Dictionary& dictionary,
                     std::span<const ChannelValue> samples);
    /// Makes the index and keeps the file; without it the file is taken away again.
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
