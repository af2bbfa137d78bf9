// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aeolis::archive {

/// What two archives hold of their runs.
struct ArchiveComparison {
    std::uint64_t runs = 0, rows = 0;      ///< of the first
    std::vector<std::string> differences;  ///< a sentence for each table that differs
};

/// Compares every row of every run, in all tables, column by column. Audits, layouts and what an archive knows of other
/// machines are its own and are not compared. Each archive is read as it is now; writers proceed meanwhile.
///
/// Memory   SQLite sorts the largest table in temporary files
Result<ArchiveComparison> compare(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace aeolis::archive
