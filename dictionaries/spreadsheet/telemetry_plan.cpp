// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/telemetry_plan.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/spreadsheet/table.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace aeolis::dictionary {
namespace {

constexpr std::string_view every_plan = "all";
constexpr std::string_view event_reports = "events";

/// Names that the sheet's rows may use, with APIDs: each packet of the vehicle by name, the event reports as one.
std::map<std::string, Apid> planned_packets(const std::vector<Packet>& packets) {
    std::map<std::string, Apid> planned;
    for (const Packet& packet : packets)
        if (!is_made_on_ground(packet.apid))
            planned.emplace(packet.event ? std::string{event_reports} : packet.name, packet.apid);
    return planned;
}

TelemetryPlanRow read_row(RowReader& cells) {
    TelemetryPlanRow row;
    row.plan = cells.identifier("plan");
    row.packet = cells.required_text("packet");
    row.line = cells.line();
    row.note = cells.text("note");
    const auto word = std::ranges::find(telemetry_priority_words, cells.text("priority"));
    if (word == telemetry_priority_words.end())
        cells.fault("priority " + in_quotes(cells.text("priority")) + " is none of first, high, normal, low");
    else
        row.priority = static_cast<TelemetryPriority>(word - telemetry_priority_words.begin());
    for (std::size_t i = 0; i < row.every.size(); ++i) {
        const std::string column{telemetry_state_columns[i]};
        const auto every = cells.integer(column, 0, telemetry_every_max);
        row.every[i] = static_cast<std::uint32_t>(every.value_or(1));
        if (every && row.priority == TelemetryPriority::first && *every != 1)
            cells.fault(column + " " + cells.text(column) + ": what goes first is never thinned, so 1");
    }
    row.recorded_hz = static_cast<std::uint32_t>(cells.integer("recorded_hz", 0, recorded_hz_max).value_or(0));
    return row;
}

void check_complete(const std::vector<TelemetryPlanRow>& rows, const std::map<std::string, Apid>& packets,
                    Findings& findings) {
    std::set<std::string> plans;
    for (const TelemetryPlanRow& row : rows)
        if (row.plan != every_plan) plans.insert(row.plan);
    if (plans.empty()) findings.add(1, "no plan is named: each row says 'all'");
    for (const std::string& plan : plans)
        for (const auto& [packet, apid] : packets) {
            const auto speaks = [&, &name = packet](const TelemetryPlanRow& row) {
                return row.packet == name && (row.plan == plan || row.plan == every_plan);
            };
            const auto first = std::ranges::find_if(rows, speaks);
            if (first == rows.end()) {
                findings.add(1, "plan " + in_quotes(plan) + " says nothing of packet " + in_quotes(packet) +
                                    ": add a row for it, with 0 where it shall only be recorded");
                continue;
            }
            const auto second = std::find_if(std::next(first), rows.end(), speaks);
            if (second != rows.end())
                findings.add(second->line, "packet " + in_quotes(packet) + ": plan " + in_quotes(plan) +
                                               " has it already, in line " + std::to_string(first->line));
        }
}

}  // namespace

std::optional<std::vector<TelemetryPlanRow>>
read_telemetry_plan(std::string_view text, const std::vector<Packet>* packets, Findings& findings) {
    const auto table = Table::read(
        text, {"plan", "packet", "priority", "before_entry", "entry", "descent", "landed", "recorded_hz", "note"},
        findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > telemetry_plan_rows_max) {
        findings.add(table->rows()[telemetry_plan_rows_max].line,
                     "more than " + std::to_string(telemetry_plan_rows_max) + " rows");
        return std::nullopt;
    }
    std::map<std::string, Apid> planned;
    if (packets != nullptr) planned = planned_packets(*packets);
    std::vector<TelemetryPlanRow> rows;
    for (const Sheet::Row& line : table->rows()) {
        RowReader cells{*table, line, "packet", "packet", findings};
        TelemetryPlanRow row = read_row(cells);
        if (const auto known = planned.find(row.packet); known != planned.end())
            row.apid = known->second;
        else if (packets != nullptr && !row.packet.empty())
            cells.fault("there is no such packet");
        rows.push_back(std::move(row));
    }
    if (packets != nullptr) check_complete(rows, planned, findings);
    return rows;
}

}  // namespace aeolis::dictionary
