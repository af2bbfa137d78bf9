// SPDX-License-Identifier: Apache-2.0
#include "server/archive/item_rows.hpp"

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

}  // namespace aeolis::archive
