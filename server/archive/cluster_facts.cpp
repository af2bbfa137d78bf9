// SPDX-License-Identifier: Apache-2.0
#include "server/archive/cluster_facts.hpp"

namespace aeolis::archive {
namespace {

constexpr char fact_identity[] = "archive";
constexpr char cluster_tables_sql[] =
    "CREATE TABLE IF NOT EXISTS cluster (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS published_runs (run INTEGER PRIMARY KEY, position BLOB NOT NULL, state TEXT NOT NULL)"
    " STRICT";

Result<bool> has_tables(sqlite::Database& database) {
    const auto found = database.integer_of("SELECT count(*) FROM sqlite_schema WHERE name = 'cluster'");
    if (!found) return found.error();
    return *found != 0;
}

}  // namespace

Result<std::string> cluster_fact(sqlite::Database& database, const std::string& name) {
    const auto known = has_tables(database);
    if (!known) return known.error();
    if (!*known) return std::string{};
    auto row = database.prepare("SELECT value FROM cluster WHERE name = ?");
    if (!row) return row.error();
    row->bind(1, std::string_view{name});
    const auto found = row->step();
    if (!found) return found.error();
    return *found ? std::string{row->text(0)} : std::string{};
}

Result<void> keep_cluster_fact(sqlite::Database& database, const std::string& name, const std::string& value) {
    if (auto made = database.execute(cluster_tables_sql); !made) return made;
    auto row = database.prepare("INSERT OR REPLACE INTO cluster VALUES (?, ?)");
    if (!row) return row.error();
    return row->bind(1, std::string_view{name}).bind(2, std::string_view{value}).run();
}

Result<std::string> cluster_identity(sqlite::Database& database) {
    auto known = cluster_fact(database, fact_identity);
    if (!known || !known->empty()) return known;
    if (auto made = database.execute(cluster_tables_sql); !made) return made.error();
    if (auto drawn = database.execute("INSERT INTO cluster VALUES ('archive', lower(hex(randomblob(16))))"
                                      " ON CONFLICT DO NOTHING");
        !drawn)
        return drawn.error();
    return cluster_fact(database, fact_identity);
}

Result<std::string> origin_of_runs(sqlite::Database& database) {
    auto followed = cluster_fact(database, fact_origin);
    if (!followed || !followed->empty()) return followed;
    return cluster_fact(database, fact_identity);
}

Result<std::map<std::uint32_t, PublishedRun>> published_runs(sqlite::Database& database) {
    std::map<std::uint32_t, PublishedRun> runs;
    const auto known = has_tables(database);
    if (!known) return known.error();
    if (!*known) return runs;
    auto rows = database.prepare("SELECT run, position, state FROM published_runs");
    if (!rows) return rows.error();
    for (;;) {
        const auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return runs;
        const auto number = static_cast<std::uint32_t>(rows->integer(0));
        const auto octets = rows->octets(1);
        PublishedRun run{RunId{number}, {}, std::string{rows->text(2)}};
        if (run.position.ParseFromArray(octets.data(), static_cast<int>(octets.size())))
            runs.emplace(number, std::move(run));
    }
}

Result<void> keep_published_runs(sqlite::Database& database, std::span<const PublishedRun> runs, bool all) {
    if (auto made = database.execute(cluster_tables_sql); !made) return made;
    if (all)
        if (auto cleared = database.execute("DELETE FROM published_runs"); !cleared) return cleared;
    auto row = database.prepare("INSERT OR REPLACE INTO published_runs VALUES (?, ?, ?)");
    if (!row) return row.error();
    for (const auto& run : runs) {
        const auto octets = run.position.SerializeAsString();
        row->bind(1, std::int64_t{run.run.value})
            .bind_octets(2, {reinterpret_cast<const std::uint8_t*>(octets.data()), octets.size()})
            .bind(3, std::string_view{run.state});
        if (auto done = row->run(); !done) return done;
    }
    return {};
}

}  // namespace aeolis::archive
