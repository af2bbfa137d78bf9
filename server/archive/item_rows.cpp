// SPDX-License-Identifier: Apache-2.0
#include "server/archive/item_rows.hpp"

#include "server/archive/item_keys.hpp"

namespace aeolis::archive {

std::string joined(const std::vector<ColumnText>& columns, std::string ColumnText::* text, const char* between) {
    std::string all;
    for (const auto& column : columns) all += (all.empty() ? "" : between) + column.*text;
    return all;
}

std::span<const std::uint8_t> octets_of_packet(const sqlite::Statement& row) {
    static const auto columns = columns_of<ItemTable, PacketRecord>();
    static const auto octets = std::ranges::find(columns, "octets", &ColumnText::name) - columns.begin();
    return row.octets(2 + static_cast<int>(octets));
}

std::string item_keys_sql(const std::string& schema) {
    std::string sql = "SELECT key + 1 AS key FROM " + schema + "packets WHERE key BETWEEN ?1 AND ?2 AND sampled = 1";
    for_item_kinds([&]<typename Record>(ItemKind<Record>) {
        sql += " UNION ALL SELECT key FROM " + schema + ItemTable<Record>::name + " WHERE key BETWEEN ?1 AND ?2";
    });
    return sql;
}

}  // namespace aeolis::archive
