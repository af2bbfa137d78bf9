// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace aeolis::dictionary {
namespace {

struct Anchor {
    std::string name;
    std::string parent;  ///< empty: none, or unknown
    MaybeOffset offset_s;
    std::string note;
    unsigned line = 0;
    bool placed = false;
};

void check_parents(std::vector<Anchor>& anchors, const std::map<std::string, std::size_t>& by_name,
                   Findings& findings) {
    const Anchor* root = nullptr;
    for (Anchor& anchor : anchors) {
        if (!anchor.parent.empty()) {
            if (by_name.contains(anchor.parent)) continue;
            findings.add(anchor.line,
                         "anchor " + in_quotes(anchor.name) + ": there is no anchor " + in_quotes(anchor.parent));
            anchor.parent.clear();
        } else if (root != nullptr) {
            findings.add(anchor.line, "anchor " + in_quotes(anchor.name) + " has no parent; only the root, " +
                                          in_quotes(root->name) + ", has none");
        } else {
            root = &anchor;
        }
    }
    if (root == nullptr) findings.add(1, "no anchor is the root: each has a parent");
}

/// Follows parents from `start` until one repeats, and reports the cycle once.
void report_cycle(std::vector<Anchor>& anchors, const std::map<std::string, std::size_t>& by_name, std::size_t start,
                  Findings& findings) {
    std::vector<std::size_t> path;
    std::size_t at = start;
    while (!anchors[at].placed && std::ranges::find(path, at) == path.end()) {
        path.push_back(at);
        at = by_name.at(anchors[at].parent);
    }
    const auto ring = std::ranges::find(path, at);
    if (ring != path.end()) {
        std::string text;
        for (auto step = ring; step != path.end(); ++step) text += anchors[*step].name + " -> ";
        findings.add(anchors[at].line,
                     "anchor " + in_quotes(anchors[at].name) + ": a cycle of anchors: " + text + anchors[at].name);
    }
    for (const std::size_t step : path) anchors[step].placed = true;
}

/// Order with parents before children; otherwise the order of the file is kept.
std::vector<std::size_t> topological_order(std::vector<Anchor>& anchors,
                                           const std::map<std::string, std::size_t>& by_name, Findings& findings) {
    std::vector<std::size_t> order;
    for (bool progress = true; progress;) {
        progress = false;
        for (std::size_t i = 0; i < anchors.size(); ++i) {
            Anchor& anchor = anchors[i];
            if (anchor.placed || (!anchor.parent.empty() && !anchors[by_name.at(anchor.parent)].placed)) continue;
            anchor.placed = true;
            order.push_back(i);
            progress = true;
        }
    }
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        if (anchors[i].placed) continue;
        report_cycle(anchors, by_name, i, findings);
    }
    return order;
}

std::vector<Anchor> read_rows(const Table& table, Findings& findings) {
    std::vector<Anchor> anchors;
    for (const Sheet::Row& row : table.rows()) {
        RowReader cells{table, row, "anchor", "name", findings};
        Anchor anchor{cells.identifier("name"), cells.text("parent"), {}, cells.text("note"), row.line, false};
        if (!anchor.parent.empty())
            anchor.offset_s = cells.offset("offset_s");
        else if (!cells.text("offset_s").empty())
            cells.fault("the root stands at zero and has no offset");
        else
            anchor.offset_s = 0.0;
        if (anchor.name == "previous" || anchor.name == "undefined") cells.fault("the name means something else");
        anchors.push_back(std::move(anchor));
    }
    return anchors;
}

}  // namespace

std::optional<std::vector<AnchorRow>> read_anchors(std::string_view text, Findings& findings) {
    const auto table = Table::read(text, {"name", "parent", "offset_s", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > anchors_max) {
        findings.add(table->rows()[anchors_max].line, "more than " + std::to_string(anchors_max) + " anchors");
        return std::nullopt;
    }
    std::vector<Anchor> anchors = read_rows(*table, findings);
    std::map<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < anchors.size(); ++i)
        if (!by_name.emplace(anchors[i].name, i).second)
            findings.add(anchors[i].line, "anchor " + in_quotes(anchors[i].name) + " is there twice, first in line " +
                                              std::to_string(anchors[by_name[anchors[i].name]].line));
    check_parents(anchors, by_name, findings);

    std::vector<AnchorRow> rows;
    std::map<std::string, AnchorId> placed;
    for (const std::size_t index : topological_order(anchors, by_name, findings)) {
        const Anchor& anchor = anchors[index];
        const AnchorId id{static_cast<std::uint16_t>(rows.size())};
        const auto parent = placed.find(anchor.parent);
        rows.push_back({id, anchor.name, parent == placed.end() ? std::nullopt : std::optional{parent->second},
                        anchor.offset_s, anchor.note});
        placed.emplace(anchor.name, id);
    }
    for (const Anchor& anchor : anchors)  // anchors on a cycle still count as names
        if (!placed.contains(anchor.name)) rows.push_back({AnchorId{}, anchor.name, {}, {}, anchor.note});
    return rows;
}

}  // namespace aeolis::dictionary
