// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace aeolis::dictionary {
namespace {

using LinesByName = std::map<std::string, unsigned>;

void read_reference(RowReader& cells, const TimelineContext& context, TimelineRow& row) {
    const std::string& reference = cells.text("reference");
    if (reference == "previous" || context.anchors == nullptr) return;
    const auto anchor = std::ranges::find(*context.anchors, reference, &AnchorRow::name);
    if (anchor == context.anchors->end())
        cells.fault("reference " + in_quotes(reference) + " is neither previous nor an anchor");
    else
        row.anchor = anchor->id;
}

void read_action(RowReader& cells, TimelineRow& row) {
    row.action = cells.text("action").empty() ? std::string{} : cells.identifier("action");
    row.reply_timeout_s = cells.offset("reply_timeout_s");
    if (!row.reply_timeout_s) return;
    if (*row.reply_timeout_s <= 0.0) cells.fault("reply_timeout_s is not above 0");
    if (row.action.empty()) cells.fault("waits for a reply, but has no action that could bring one");
}

/// Empty where no reply is waited for, and only there.
void read_if_unverified(RowReader& cells, TimelineRow& row) {
    const std::string& word = cells.text("if_unverified");
    if (word.empty() != !row.reply_timeout_s)
        return cells.fault(word.empty() ? "waits for a reply, but if_unverified does not say what holds without one"
                                        : "if_unverified is set, but no reply is waited for");
    if (word.empty()) return;
    for (const auto taken : {IfUnverified::done, IfUnverified::not_done, IfUnverified::done_unless_imu}) {
        row.if_unverified = taken;
        if (word == name_of(taken)) return;
    }
    cells.fault("if_unverified " + in_quotes(word) + " is none of done, not_done, done_unless_imu");
}

/// The timeline may be held where it can also go back: before separation. R32, R50
void read_hold(RowReader& cells, TimelineRow& row) {
    if (cells.text("hold_repeat_s").empty()) return;
    row.hold_repeat_s = cells.offset("hold_repeat_s");
    if (!row.hold_repeat_s || *row.hold_repeat_s <= 0.0)
        cells.fault("hold_repeat_s is not above 0");
    else if (!row.reply_timeout_s || *row.hold_repeat_s >= *row.reply_timeout_s)
        cells.fault("hold_repeat_s is not below reply_timeout_s, which ends it");
    if (row.backtrack.empty()) cells.fault("hold_repeat_s without a backtrack_point: held before separation only");
}

void read_tone(RowReader& cells, const TimelineContext& context, TimelineRow& row) {
    const std::string& name = cells.text("tone");
    if (name.empty() || context.tones == nullptr) return;
    const auto tone = std::ranges::find(*context.tones, name, &ToneRow::name);
    if (tone == context.tones->end())
        cells.fault("there is no tone " + in_quotes(name));
    else if (tone->set != ToneSet::prime)
        cells.fault("tone " + in_quotes(name) + " is not one of prime's; Second Chance finds its own");
    else
        row.tone = tone->id;
}

void read_event(RowReader& cells, const TimelineContext& context, TimelineRow& row) {
    row.event = cells.text("event");
    if (row.event.empty() || context.events == nullptr) return;
    const auto event = std::ranges::find(*context.events, row.event, &TimelineContext::DeclaredEvent::name);
    if (event == context.events->end())
        cells.fault("there is no event " + in_quotes(row.event));
    else if (event->has_arguments)
        cells.fault("event " + in_quotes(row.event) + " has arguments; a timepoint announces only events without");
}

/// Reads the backtrack point: after a reboot, a timepoint at or before the interrupted one. R32
void read_backtrack(RowReader& cells, const LinesByName& all, const LinesByName& so_far, TimelineRow& row) {
    row.backtrack = cells.text("backtrack_point");
    if (row.backtrack.empty() || so_far.contains(row.backtrack)) return;
    cells.fault(all.contains(row.backtrack) ? "backtrack point " + in_quotes(row.backtrack) + " comes later"
                                            : "there is no timepoint " + in_quotes(row.backtrack) + " to backtrack to");
}

}  // namespace

std::optional<std::vector<TimelineRow>> read_timeline(std::string_view text, const TimelineContext& context,
                                                      Findings& findings) {
    const auto table = Table::read(text,
                                   {"name", "reference", "desired_offset_s", "minimum_offset_s", "action",
                                    "reply_timeout_s", "if_unverified", "hold_repeat_s", "backtrack_point", "essential",
                                    "may_be_late", "tone", "event", "note"},
                                   findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > timepoints_max) {
        findings.add(table->rows()[timepoints_max].line, "more than " + std::to_string(timepoints_max) + " timepoints");
        return std::nullopt;
    }
    if (table->rows().empty()) findings.add(1, "the timeline has no timepoint");

    LinesByName all;
    for (const Sheet::Row& row : table->rows()) all.emplace(row.cells[table->column("name")], row.line);
    LinesByName so_far;
    std::vector<TimelineRow> rows;
    for (const Sheet::Row& sheet_row : table->rows()) {
        RowReader cells{*table, sheet_row, "timepoint", "name", findings};
        TimelineRow row;
        row.id = TimepointId{static_cast<std::uint16_t>(rows.size())};
        row.line = sheet_row.line;
        row.name = cells.identifier("name");
        const auto [first, added] = so_far.emplace(row.name, row.line);
        if (!added) cells.fault("is there twice, first in line " + std::to_string(first->second));
        read_reference(cells, context, row);
        row.desired_offset_s = cells.offset("desired_offset_s");
        row.minimum_offset_s = cells.offset("minimum_offset_s");
        read_action(cells, row);
        read_if_unverified(cells, row);
        read_backtrack(cells, all, so_far, row);
        read_hold(cells, row);
        row.essential = cells.yes_or_no("essential");
        row.may_be_late = cells.yes_or_no("may_be_late");
        if (row.may_be_late && cells.text("reference") == "previous")
            cells.fault("may_be_late without an anchor: it follows the row before it");
        read_tone(cells, context, row);
        read_event(cells, context, row);
        row.note = cells.text("note");
        if (row.action.empty() && row.note.empty())
            cells.fault("has no action, and its note does not say what it is for");
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace aeolis::dictionary
