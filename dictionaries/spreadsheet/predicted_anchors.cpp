// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace aeolis::dictionary {

std::optional<std::vector<std::optional<double>>>
read_predicted_anchors(std::string_view text, const std::vector<AnchorRow>* anchors, Findings& findings) {
    const auto table = Table::read(text, {"anchor", "after_entry_s", "note"}, findings);
    if (!table) return std::nullopt;
    std::vector<std::optional<double>> predicted(anchors == nullptr ? 0 : anchors->size());
    for (const Sheet::Row& line : table->rows()) {
        RowReader cells{*table, line, "anchor", "anchor", findings};
        const std::string name = cells.identifier("anchor");
        const auto after_entry_s = cells.number("after_entry_s");
        if (after_entry_s && std::abs(*after_entry_s) > 1.0e6)
            cells.fault("after_entry_s: is more than 1000000 s from entry");
        if (anchors == nullptr) continue;
        const auto known = std::ranges::find(*anchors, name, &AnchorRow::name);
        if (known == anchors->end()) {
            cells.fault("there is no such anchor in anchors.csv");
            continue;
        }
        auto& place = predicted[static_cast<std::size_t>(known - anchors->begin())];
        if (place) cells.fault("is there twice");
        if (after_entry_s) place = *after_entry_s;
    }
    return predicted;
}

}  // namespace aeolis::dictionary
