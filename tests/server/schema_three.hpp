// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/column_codec.hpp"
#include "server/archive/sqlite.hpp"
#include "tests/support/catch.hpp"

#include <filesystem>
#include <utility>
#include <vector>

namespace aeolis::test {

/// Makes an archive what it was before segments were packed: plain doubles, no positions, no pyramid.
inline void make_schema_three(const std::filesystem::path& file) {
    namespace sqlite = archive::sqlite;
    auto database = std::move(sqlite::Database::open(file.string(), sqlite::Mode::read_write_create)).value();
    archive::ColumnCodec codec;
    const auto unpack_all = [&](const char* select, const char* update) {
        std::vector<std::pair<std::int64_t, std::vector<double>>> columns;
        auto rows = database.prepare(select);
        REQUIRE(rows.ok());
        while (*rows->step()) {
            auto& [key, column] = columns.emplace_back();
            key = rows->integer(0);
            column.resize(static_cast<std::size_t>(rows->integer(1)));
            REQUIRE(codec.unpack(rows->octets(2), column).ok());
        }
        auto change = database.prepare(update);
        REQUIRE(change.ok());
        for (const auto& [key, column] : columns) {
            const auto* const octets = reinterpret_cast<const std::uint8_t*>(column.data());
            change->bind(1, key).bind_octets(2, {octets, column.size() * sizeof(double)});
            REQUIRE(change->run().ok());
        }
    };
    REQUIRE(database.execute("BEGIN").ok());
    unpack_all("SELECT c.key, s.samples, c.value FROM segment_columns c JOIN segments s ON s.segment = c.key / 65536",
               "UPDATE segment_columns SET value = ?2 WHERE key = ?1");
    unpack_all("SELECT segment, samples, sclk FROM segments", "UPDATE segments SET sclk = ?2 WHERE segment = ?1");
    REQUIRE(
        database
            .execute(
                "DROP VIEW staleness_log; DROP VIEW alarm_action_log; DROP VIEW shift_log; DROP TABLE search; DROP "
                "VIEW search_text;"
                "DROP TABLE staleness; DROP TABLE alarm_actions; DROP TABLE notes; DROP VIEW channel_segments; DROP "
                "INDEX segments_by_position; DROP TABLE pyramid; DROP TABLE pyramid_columns;"
                "DROP VIEW clock_log; DROP VIEW command_wait_log; DROP TABLE link_losses; DROP TABLE run_anchors; DROP "
                "TABLE run_clocks; DROP TABLE command_waits; DROP TABLE audit; DROP TABLE pruned_runs; DROP TABLE "
                "requests; ALTER TABLE segments DROP COLUMN position; ALTER TABLE segments DROP COLUMN packed;"
                "CREATE INDEX segments_by_packet ON segments (run, packet, source, last_unit);"
                "CREATE VIEW channel_segments AS SELECT g.run, g.sclk AS sclk_blob, v.value AS value_blob FROM "
                "segment_columns v"
                " JOIN segments g ON g.segment = v.key / 65536;"
                "PRAGMA user_version = 3; COMMIT")
            .ok());
}

}  // namespace aeolis::test
