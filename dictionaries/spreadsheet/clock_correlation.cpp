// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include <cmath>
#include <string>

namespace aeolis::dictionary {
namespace {

constexpr std::size_t clock_rows_max = 1000;  // chosen: one a week for twenty years
constexpr double drift_max = 1.0e-4;          // chosen: an oscillator with more drift is broken
constexpr double step_max_s = 0.5;  // chosen: less than a leap second, and more than the drift between two rows
constexpr std::int64_t leap_seconds_max = 99;  // chosen; 10 in 1972, 37 since 2017

ClockRow row_of(RowReader& cells) {
    ClockRow row;
    row.line = cells.line();
    row.note = cells.text("note");
    auto& clock = row.correlation;
    clock.version = static_cast<std::uint32_t>(cells.integer("version", 1, 1'000'000'000).value_or(0));
    row.valid_from = Sclk{cells.number("valid_from_sclk").value_or(0.0)};
    clock.sclk = Sclk{cells.number("sclk").value_or(0.0)};
    if (const auto scet = scet_from_text(cells.required_text("scet")))
        clock.scet = *scet;
    else
        cells.fault("scet: " + in_quotes(cells.text("scet")) + " is not a time like 2012-219T05:10:47.400");
    clock.rate = 1.0 + cells.number("drift").value_or(0.0);
    clock.leap_seconds = static_cast<std::int32_t>(cells.integer("leap_seconds", 10, leap_seconds_max).value_or(0));
    if (std::abs(clock.rate - 1.0) > drift_max) cells.fault("drift: is more than 1e-4, which no clock has");
    return row;
}

void check_order(const ClockRow& row, const ClockRow& before, RowReader& cells) {
    if (row.correlation.version <= before.correlation.version)
        cells.fault("version: is not above that of the row before");
    if (row.valid_from <= before.valid_from) return cells.fault("valid_from_sclk: is not after that of the row before");
    const std::int64_t now_us = row.correlation.scet_of(row.valid_from).microseconds;
    const std::int64_t then_us = before.correlation.scet_of(row.valid_from).microseconds;
    const int leap_s = row.correlation.leap_seconds - before.correlation.leap_seconds;  // UTC stops for a leap second
    if (std::abs(static_cast<double>(now_us - then_us) * 1.0e-6 + leap_s) > step_max_s)
        cells.fault("scet: by the row before it was " + day_of_year_text(Scet{then_us}) +
                    " at valid_from_sclk, by this one " + day_of_year_text(Scet{now_us}) +
                    "; leap seconds do not explain it");
}

}  // namespace

std::optional<std::vector<ClockRow>> read_clock_correlation(std::string_view text, Findings& findings) {
    const auto table =
        Table::read(text, {"version", "valid_from_sclk", "sclk", "scet", "drift", "leap_seconds", "note"}, findings);
    if (!table) return std::nullopt;
    if (table->rows().size() > clock_rows_max) {
        findings.add(table->rows()[clock_rows_max].line, "more than " + std::to_string(clock_rows_max) + " rows");
        return std::nullopt;
    }
    std::vector<ClockRow> rows;
    for (const Sheet::Row& line : table->rows()) {
        RowReader cells{*table, line, "version", "version", findings};
        ClockRow row = row_of(cells);
        if (!rows.empty()) check_order(row, rows.back(), cells);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace aeolis::dictionary
