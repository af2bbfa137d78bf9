// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/air_table.hpp"

#include "server/scenario/text_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

namespace aeolis::server {
namespace {

constexpr double gas_m2ps2K = 188.9;             // [facts] Mars: carbon dioxide and a little nitrogen and argon
constexpr double law_holds_below_m = 100'000.0;  // above, light gases prevail
constexpr double law_tolerance = 0.2;            // our assumption: composition differs by 3 %, units by ten
constexpr double gap_max_m = 25'000.0;           // our assumption: three scale heights are no table
constexpr std::size_t table_octets_max = 1 << 20;

enum class Column : std::uint8_t { altitude, temperature, pressure, density, east, north, scale, deviation, none };
struct Heading {
    std::string_view name;
    Column column;
    double scale;  ///< to SI
};
constexpr double metres_per_km = 1000.0;
constexpr std::array headings{
    Heading{"altitude_m", Column::altitude, 1.0},
    Heading{"altitude_km", Column::altitude, metres_per_km},
    Heading{"temperature_K", Column::temperature, 1.0},
    Heading{"pressure_Pa", Column::pressure, 1.0},
    Heading{"density_kgm3", Column::density, 1.0},
    Heading{"east_mps", Column::east, 1.0},
    Heading{"north_mps", Column::north, 1.0},
    Heading{"density_scale", Column::scale, 1.0},
    Heading{"density_deviation", Column::deviation, 1.0},
};
constexpr std::array profile_columns{
    Heading{"height", Column::altitude, metres_per_km},
    Heading{"latitude", Column::none, 1.0},
    Heading{"longitude", Column::none, 1.0},
    Heading{"temperature", Column::temperature, 1.0},
    Heading{"pressure", Column::pressure, 1.0},
    Heading{"density", Column::density, 1.0},
    Heading{"eastward wind", Column::east, 1.0},
    Heading{"northward wind", Column::north, 1.0},
};

/// A row in SI units; what a table does not have is none.
struct TableRow {
    std::size_t line = 0;
    std::array<std::optional<double>, static_cast<std::size_t>(Column::none)> values;
    std::optional<double> operator[](Column column) const { return values.at(static_cast<std::size_t>(column)); }
    std::optional<double>& at(Column column) { return values.at(static_cast<std::size_t>(column)); }
};

std::vector<std::string> words_of(const std::string& line, bool commas) {
    std::vector<std::string> words;
    std::string text = line;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    std::istringstream from{text};
    std::string word;
    while (commas ? static_cast<bool>(std::getline(from, word, ',')) : static_cast<bool>(from >> word)) {
        const auto begin = word.find_first_not_of(" \t");
        words.push_back(begin == std::string::npos ? "" : word.substr(begin, word.find_last_not_of(" \t") - begin + 1));
    }
    return words;
}

std::optional<double> number_of(const std::string& word) {
    double value = 0.0;
    const char* end = word.data() + word.size();
    const char* begin = word.starts_with('+') ? word.data() + 1 : word.data();
    const auto [stop, error] = std::from_chars(begin, end, value);
    return error == std::errc{} && stop == end && std::isfinite(value) ? std::optional{value} : std::nullopt;
}

/// The rows of a table, each above the one before.
class TableReader {
  public:
    explicit TableReader(const std::filesystem::path& file) : file_(file.string()) {}

    Result<std::vector<TableRow>> rows(bool of_air) {
        const auto text = bounded_text(file_, table_octets_max, "table");
        if (!text) return text.error();
        std::istringstream from{*text};
        std::vector<TableRow> rows;
        std::string line;
        for (std::size_t number = 1; std::getline(from, line); ++number) {
            const auto first = line.find_first_not_of(" \t\r");
            if (first == std::string::npos || line[first] == '#') continue;
            if (columns_.empty()) {
                if (const auto read = read_heading(line, number, of_air); !read) return read.error();
                continue;
            }
            auto row = row_of(line, number);
            if (!row) return row.error();
            if (!rows.empty()) {
                const double low_m = *rows.back()[Column::altitude], high_m = *(*row)[Column::altitude];
                if (high_m <= low_m)
                    return at(number, fmt::format("{} m does not lie above the row before, {} m", high_m, low_m));
                if (of_air && high_m - low_m > gap_max_m)
                    return at(number,
                              fmt::format("a gap of {} km below {} m", (high_m - low_m) / metres_per_km, high_m));
            }
            rows.push_back(*row);
        }
        if (rows.size() < 2) return Error{fmt::format("{}: has {} rows, a table needs two", file_, rows.size())};
        if (rows.size() > simulation::scenario_rows_max)
            return Error{fmt::format("{}: has {} rows, at most {} are taken", file_, rows.size(),
                                     simulation::scenario_rows_max)};
        return rows;
    }
    Error at(std::size_t line, const std::string& why) const {
        return Error{fmt::format("{}:{}: {}", file_, line, why)};
    }
    bool has(Column column) const { return std::ranges::find(columns_, column, &Heading::column) != columns_.end(); }
    const std::string& file() const { return file_; }

  private:
    Result<void> read_heading(const std::string& line, std::size_t number, bool of_air) {
        commas_ = line.find(',') != std::string::npos;
        if (!commas_ && of_air) {
            if (number_of(words_of(line, false).front()))
                return at(number, "a profile begins with a line of heading, this one is of numbers");
            columns_.assign(profile_columns.begin(), profile_columns.end());
            return {};
        }
        for (const std::string& word : words_of(line, true)) {
            const auto known = std::ranges::find(headings, word, &Heading::name);
            if (known == headings.end())
                return at(number,
                          fmt::format("column '{}' is none of altitude_m, altitude_km, temperature_K, pressure_Pa, "
                                      "density_kgm3, east_mps, north_mps, density_scale, density_deviation",
                                      word));
            if (has(known->column)) return at(number, fmt::format("column '{}' says again what another does", word));
            columns_.push_back(*known);
        }
        if (!has(Column::altitude)) return at(number, "no column is the altitude");
        return {};
    }
    Result<TableRow> row_of(const std::string& line, std::size_t number) const {
        const auto words = words_of(line, commas_);
        if (commas_ ? words.size() != columns_.size() : words.size() < columns_.size())
            return at(number, fmt::format("{} values, the heading has {}", words.size(), columns_.size()));
        TableRow row;
        row.line = number;
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const auto value = number_of(words[i]);
            if (!value) return at(number, fmt::format("'{}' is no number", words[i]));
            if (columns_[i].column != Column::none) row.at(columns_[i].column) = columns_[i].scale * *value;
        }
        return row;
    }

    std::string file_;
    bool commas_ = true;
    std::vector<Heading> columns_;
};

/// Temperature and density of a row, by the gas law where one of them is missing. The Error says what is wrong.
Result<simulation::AirRow> air_of(const TableRow& row) {
    const auto given = [&](Column column) {
        const auto value = row[column];
        return value && *value != 0.0 ? value : std::nullopt;
    };
    const auto temperature = given(Column::temperature), pressure = given(Column::pressure),
               density = given(Column::density);
    for (const auto& [value, name] :
         {std::pair{temperature, "temperature"}, std::pair{pressure, "pressure"}, std::pair{density, "density"}})
        if (value && *value < 0.0) return Error{fmt::format("a {} of {}", name, *value)};
    simulation::AirRow air;
    air.altitude_m = *row[Column::altitude];
    if (temperature && density) {
        air.temperature_K = *temperature;
        air.density_kgm3 = *density;
        const double by_law_Pa = *density * gas_m2ps2K * *temperature;
        if (pressure && air.altitude_m < law_holds_below_m && std::abs(*pressure / by_law_Pa - 1.0) > law_tolerance)
            return Error{
                fmt::format("pressure {:g} Pa, while density {:g} kg/m3 and {:g} K make {:.4g} Pa: other units?",
                            *pressure, *density, *temperature, by_law_Pa)};
    } else if (pressure && density) {
        air.density_kgm3 = *density;
        air.temperature_K = *pressure / (*density * gas_m2ps2K);
    } else if (pressure && temperature) {
        air.temperature_K = *temperature;
        air.density_kgm3 = *pressure / (gas_m2ps2K * *temperature);
    } else {
        return Error{"two of temperature, pressure and density are needed"};
    }
    constexpr double coldest_K = 50.0, hottest_K = 500.0, densest_kgm3 = 1.0;
    if (air.temperature_K < coldest_K || air.temperature_K > hottest_K || air.density_kgm3 > densest_kgm3)
        return Error{
            fmt::format("{:g} K and {:g} kg/m3 are no air of Mars: other units?", air.temperature_K, air.density_kgm3)};
    return air;
}

}  // namespace

Result<AirTable> air_table_from_file(const std::filesystem::path& file, double landing_m) {
    TableReader reader{file};
    const auto rows = reader.rows(true);
    if (!rows) return rows.error();
    AirTable table;
    table.air.reserve(rows->size());
    table.winds.reserve(rows->size());
    const bool blows = reader.has(Column::east) && reader.has(Column::north);
    for (const TableRow& row : *rows) {
        auto air = air_of(row);
        if (!air) return reader.at(row.line, air.error().message);
        air->altitude_m -= landing_m;
        table.air.push_back(*air);
        constexpr double scale_min = 0.1, scale_max = 10.0, deviation_max = 0.5;  // as a scenario takes them
        if (const double scale = row[Column::scale].value_or(1.0); !(scale >= scale_min && scale <= scale_max))
            return reader.at(row.line,
                             fmt::format("a density_scale of {} is outside {} to {}", scale, scale_min, scale_max));
        if (const double deviation = row[Column::deviation].value_or(0.0);
            !(deviation >= 0.0 && deviation <= deviation_max))
            return reader.at(row.line,
                             fmt::format("a density_deviation of {} is outside 0 to {}", deviation, deviation_max));
        if (reader.has(Column::scale) || reader.has(Column::deviation))
            table.scale.push_back(
                {air->altitude_m, row[Column::scale].value_or(1.0), row[Column::deviation].value_or(0.0)});
        if (blows) table.winds.push_back({air->altitude_m, *row[Column::east], *row[Column::north]});
    }
    return table;
}

Result<std::vector<simulation::WindRow>> wind_table_from_file(const std::filesystem::path& file) {
    TableReader reader{file};
    const auto rows = reader.rows(false);
    if (!rows) return rows.error();
    if (!reader.has(Column::east) || !reader.has(Column::north))
        return Error{reader.file() + ": a table of wind has the columns altitude_m, east_mps and north_mps"};
    std::vector<simulation::WindRow> winds;
    winds.reserve(rows->size());
    for (const TableRow& row : *rows)
        winds.push_back({*row[Column::altitude], *row[Column::east], *row[Column::north]});
    return winds;
}

}  // namespace aeolis::server
