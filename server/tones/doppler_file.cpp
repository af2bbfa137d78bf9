// SPDX-License-Identifier: Apache-2.0
#include "server/tones/doppler_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

namespace aeolis::server {
namespace {

constexpr double written_row_s = 0.25;        // chosen: a cubic between rows holds the entry's Doppler to some hertz
constexpr std::size_t rows_max = 10'000'000;  // chosen: days at 64 a second

std::vector<std::string> cells_of(std::string line) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    std::vector<std::string> cells;
    std::size_t from = 0;
    for (std::size_t to = 0; to != std::string::npos; from = to + 1) {
        to = line.find(',', from);
        cells.push_back(line.substr(from, to == std::string::npos ? to : to - from));
    }
    return cells;
}

std::optional<double> number_in(const std::string& cell) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// Two columns of numbers: the first, and one selected by name.
struct Columns {
    std::vector<double> first, second;
};
Result<Columns> read_columns(const std::filesystem::path& file, const std::string& wanted,
                             const std::function<bool(const std::string&)>& is_second) {
    std::ifstream stream{file};
    if (!stream) return Error{fmt::format("{} cannot be read", file.string())};
    std::string line;
    std::size_t number = 0, second = 0;
    Columns columns;
    while (std::getline(stream, line)) {
        ++number;
        if (line.empty() || line[0] == '#') continue;
        const auto cells = cells_of(line);
        if (second == 0) {
            const auto found = std::find_if(cells.begin() + 1, cells.end(), is_second);
            if (found == cells.end())
                return Error{fmt::format("{}:{}: there is no column {}", file.string(), number, wanted)};
            second = static_cast<std::size_t>(found - cells.begin());
            continue;
        }
        const auto a = number_in(cells[0]);
        const auto b = cells.size() > second ? number_in(cells[second]) : std::nullopt;
        if (!a || !b) return Error{fmt::format("{}:{}: no number for time or {}", file.string(), number, wanted)};
        if (columns.first.size() == rows_max)
            return Error{fmt::format("{}: more than {} rows", file.string(), rows_max)};
        columns.first.push_back(*a);
        columns.second.push_back(*b);
    }
    if (columns.first.empty()) return Error{fmt::format("{} has no rows", file.string())};
    return columns;
}

}  // namespace

Result<TimeTable> read_doppler(const std::filesystem::path& file) {
    auto columns = read_columns(file, "doppler_hz",
                                [](const std::string& name) { return name.find("doppler_hz") != std::string::npos; });
    if (!columns) return columns.error();
    auto table = TimeTable::make(std::move(columns->first), std::move(columns->second));
    if (!table) return Error{fmt::format("{}: {}", file.string(), table.error().message)};
    return table;
}

Result<TimeTable> write_doppler(const std::filesystem::path& file, const TimeTable& doppler_hz, double from_s,
                                double to_s) {
    std::ofstream stream{file};
    stream << "time_s,doppler_hz\n";
    const auto rows = static_cast<std::size_t>(std::ceil(std::max(0.0, to_s - from_s) / written_row_s)) + 1;
    if (rows > rows_max) return Error{fmt::format("{}: {} rows are too many", file.string(), rows)};
    for (std::size_t row = 0; row < rows; ++row) {
        const double time_s = from_s + static_cast<double>(row) * written_row_s;
        stream << fmt::format("{:.4f},{:.4f}\n", time_s, doppler_hz.at(time_s));
    }
    stream.close();
    if (!stream) return Error{fmt::format("{} cannot be written", file.string())};
    return read_doppler(file);
}

Result<std::vector<simulation::SentTone>> read_tones_to_send(const std::filesystem::path& file, double symbol_s) {
    const auto columns = read_columns(file, "tone", [](const std::string& name) { return name == "tone"; });
    if (!columns) return columns.error();
    std::vector<simulation::SentTone> tones;
    for (std::size_t i = 0; i < columns->first.size(); ++i) {
        const double start_s = columns->first[i], tone = columns->second[i];
        if (tone != std::floor(tone) || tone < 0.0 || tone >= MfskWaveform::tones)
            return Error{fmt::format("{}: row {}: there is no tone {}", file.string(), i + 1, tone)};
        if (!tones.empty() && start_s < tones.back().start_s + symbol_s - 1e-9)
            return Error{fmt::format("{}: row {}: begins before the tone before has ended", file.string(), i + 1)};
        tones.push_back({start_s, static_cast<std::uint8_t>(tone)});
    }
    return tones;
}

}  // namespace aeolis::server
