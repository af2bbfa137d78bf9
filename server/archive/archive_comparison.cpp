// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive_comparison.hpp"

#include "server/archive/schema.hpp"
#include "server/archive/sqlite.hpp"

namespace aeolis::archive {
namespace {

constexpr char other_name[] = "compared";

/// The rows of a table in one of the two files.
std::string rows_of(const std::string& file, const std::string& table) {
    // The search index has no rows of its own, but a number for each text in it.
    return table == "search" ? "SELECT id FROM " + file + ".search_docsize" : "SELECT * FROM " + file + '.' + table;
}

Result<std::uint64_t> count(sqlite::Database& database, const std::string& rows) {
    const auto counted = database.integer_of(("SELECT count(*) FROM (" + rows + ")").c_str());
    if (!counted) return counted.error();
    return static_cast<std::uint64_t>(*counted);
}

Result<void> check(const std::filesystem::path& file) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    if (!database) return database.error();
    return check_for_reading(*database);
}

}  // namespace

Result<ArchiveComparison> compare(const std::filesystem::path& one, const std::filesystem::path& other) {
    for (const auto& file : {one, other})
        if (auto ours = check(file); !ours) return ours.error();
    auto database = sqlite::Database::open(one.string(), sqlite::Mode::read_only);
    if (!database) return database.error();
    if (auto attached = database->attach_read_only(other, other_name); !attached) return attached.error();
    const auto snapshot = sqlite::Transaction::begin_read(*database);
    if (!snapshot) return snapshot.error();
    ArchiveComparison found;
    for (const auto& table : run_tables()) {
        const auto here = rows_of("main", table.name), there = rows_of(other_name, table.name);
        const auto all_here = count(*database, here), all_there = count(*database, there);
        if (!all_here) return all_here.error();
        if (!all_there) return all_there.error();
        // No table holds a row twice: each has a key.
        const auto only_here = count(*database, here + " EXCEPT " + there);
        if (!only_here) return only_here.error();
        found.rows += *all_here;
        if (std::string{table.name} == "runs") found.runs = *all_here;
        const auto only_there = *all_there - (*all_here - *only_here);
        if (*only_here == 0 && only_there == 0) continue;
        found.differences.push_back(std::string{table.name} + ": " + std::to_string(*only_here) + " rows only in " +
                                    one.string() + ", " + std::to_string(only_there) + " only in " + other.string());
    }
    return found;
}

}  // namespace aeolis::archive
