// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace aeolis::dictionary {
namespace {

constexpr std::int64_t priority_max = 255;  // ToneSelected holds the priority in one octet

struct Read {
    ToneRow tone;
    unsigned line = 0;
};

std::optional<ToneSet> to_set(const std::string& word) {
    if (word == "prime") return ToneSet::prime;
    if (word == "second_chance") return ToneSet::second_chance;
    if (word == "spare") return ToneSet::spare;
    return std::nullopt;
}

ToneRow read_tone_row(RowReader& cells) {
    ToneRow tone;
    if (const auto set = to_set(cells.text("set")))
        tone.set = *set;
    else
        cells.fault("set " + in_quotes(cells.text("set")) + " is none of prime, second_chance, spare");
    tone.name = tone.set == ToneSet::spare ? cells.text("name") : cells.identifier("name");
    if (tone.set == ToneSet::spare && !tone.name.empty() && cells.text("set") == "spare")
        cells.fault("a spare tone has no name");
    tone.meaning = cells.required_text("meaning");
    tone.priority = static_cast<int>(cells.integer("priority", 0, priority_max).value_or(0));
    tone.expires_s = cells.number("expires_s").value_or(0.0);
    if (tone.set != ToneSet::spare && tone.expires_s <= 0.0) cells.fault("expires_s is not above 0");
    tone.supersedes = cells.text("supersedes");
    return tone;
}

void check_names(const std::vector<Read>& tones, Findings& findings) {
    std::map<std::string, const Read*> by_name;
    for (const Read& read : tones) {
        if (read.tone.name.empty()) continue;
        const auto [first, added] = by_name.emplace(read.tone.name, &read);
        if (!added)
            findings.add(read.line, "tone " + in_quotes(read.tone.name) + " is there twice, first in line " +
                                        std::to_string(first->second->line));
    }
    for (const auto& [tone, line] : tones) {
        if (!tone.supersedes.empty()) {
            const auto other = by_name.find(tone.supersedes);
            if (other == by_name.end())
                findings.add(line, "tone " + in_quotes(tone.name) + ": there is no tone " + in_quotes(tone.supersedes));
            else if (other->second->tone.set != tone.set)
                findings.add(line, "tone " + in_quotes(tone.name) + " supersedes " + in_quotes(tone.supersedes) +
                                       " of another set");
        }
        if (tone.set == ToneSet::prime && !tone.name.empty() &&
            !by_name.contains(std::string{second_chance_prefix} + tone.name))
            findings.add(line, "tone " + in_quotes(tone.name) + ": there is no Second Chance tone " +
                                   in_quotes(std::string{second_chance_prefix} + tone.name));
    }
}

}  // namespace

std::optional<std::vector<ToneRow>> read_tones(std::string_view text, Findings& findings) {
    const auto table =
        Table::read(text, {"id", "set", "name", "meaning", "priority", "expires_s", "supersedes"}, findings);
    if (!table) return std::nullopt;
    std::map<std::int64_t, unsigned> lines;
    std::vector<Read> tones;
    for (const Sheet::Row& row : table->rows()) {
        RowReader cells{*table, row, "tone", "id", findings};
        const auto id = cells.integer("id", 0, static_cast<std::int64_t>(tones_count) - 1);
        Read read{read_tone_row(cells), row.line};
        if (id) {
            read.tone.id = ToneId{static_cast<std::uint8_t>(*id)};
            const auto [first, added] = lines.emplace(*id, row.line);
            if (!added) cells.fault("the id is there twice, first in line " + std::to_string(first->second));
        }
        tones.push_back(std::move(read));
    }
    if (tones.size() != tones_count)
        findings.add(1, "there are " + std::to_string(tones.size()) + " tones, not " + std::to_string(tones_count));
    check_names(tones, findings);

    std::vector<ToneRow> rows;
    rows.reserve(tones.size());
    for (Read& read : tones) rows.push_back(std::move(read.tone));
    std::ranges::stable_sort(rows, {}, &ToneRow::id);
    return rows;
}

}  // namespace aeolis::dictionary
