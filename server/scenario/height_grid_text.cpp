// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/height_grid_text.hpp"

#include "server/scenario/text_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::size_t grid_octets_max = 1 << 20;
constexpr std::size_t grid_nodes_max = 1 << 16;  // chosen: each run keeps the grid
constexpr double cell_max_m = 10000.0;           // our assumption: coarser is no ground to land on
constexpr double height_max_m = 10000.0;         // our assumption: nothing within reach of a target is as high
constexpr double to_mm = 1000.0;                 // heights are kept to a millimetre, so that their text stays short
constexpr double steepest_step = 5.0;            // our assumption: 79 degrees

enum class GridKey : std::uint8_t { columns, rows, x_corner, x_center, y_corner, y_center, cell, none };
constexpr std::array<std::string_view, 8> grid_keys{"ncols",     "nrows",     "xllcorner", "xllcenter",
                                                    "yllcorner", "yllcenter", "cellsize",  "nodata_value"};

std::optional<double> finite_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc{} && stop == word.data() + word.size() && std::isfinite(value) ? std::optional{value}
                                                                                             : std::nullopt;
}

/// As grids of floating point say that there is no height.
bool is_nan(std::string_view word) {
    return word == "nan" || word == "NaN" || word == "NAN" || word == "-nan";
}

/// A text's lines, and their words.
class GridLines {
  public:
    explicit GridLines(std::string_view text) : rest_(text) {}
    /// The words of the next line that has any; none at the end.
    std::vector<std::string_view> next() {
        std::vector<std::string_view> words;
        while (words.empty() && !rest_.empty()) {
            const auto end = rest_.find('\n');
            std::string_view line = rest_.substr(0, end);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
            ++number_;
            constexpr std::string_view spaces = " \t\r";
            for (auto begin = line.find_first_not_of(spaces); begin != std::string_view::npos;
                 begin = line.find_first_not_of(spaces)) {
                line.remove_prefix(begin);
                const auto length = std::min(line.find_first_of(spaces), line.size());
                words.push_back(line.substr(0, length));
                line.remove_prefix(length);
            }
        }
        return words;
    }
    std::size_t number() const { return number_; }
    Error error(const std::string& why) const { return Error{fmt::format("line {}: {}", number_, why)}; }

  private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// What stands before the rows of heights.
struct GridHeader {
    std::array<std::optional<double>, grid_keys.size()> values{};
    const std::optional<double>& operator[](GridKey key) const { return values.at(static_cast<std::size_t>(key)); }
};

std::optional<std::size_t> grid_key_of(std::string_view word) {
    for (std::size_t i = 0; i < grid_keys.size(); ++i)
        if (std::ranges::equal(word, grid_keys[i],
                               [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; }))
            return i;
    return std::nullopt;
}

Result<void> check_header(const GridHeader& header, const GridLines& lines) {
    for (const GridKey key : {GridKey::columns, GridKey::rows, GridKey::cell})
        if (!header[key])
            return lines.error(
                fmt::format("{} is missing before the first row", grid_keys.at(static_cast<std::size_t>(key))));
    if (header[GridKey::x_corner].has_value() == header[GridKey::x_center].has_value())
        return lines.error("one of xllcorner and xllcenter is needed before the first row");
    if (header[GridKey::y_corner].has_value() == header[GridKey::y_center].has_value())
        return lines.error("one of yllcorner and yllcenter is needed before the first row");
    const double columns = *header[GridKey::columns], rows = *header[GridKey::rows], cell_m = *header[GridKey::cell];
    if (columns < 2.0 || rows < 2.0 || columns != std::floor(columns) || rows != std::floor(rows))
        return lines.error(fmt::format("{:g} columns and {:g} rows are no grid", columns, rows));
    if (columns * rows > static_cast<double>(grid_nodes_max))
        return lines.error(fmt::format("{:g} columns and {:g} rows are more than {} heights: crop the grid, or take "
                                       "larger cells",
                                       columns, rows, grid_nodes_max));
    if (!(cell_m > 0.0 && cell_m <= cell_max_m))
        return lines.error(fmt::format("a cellsize of {:g} is not above 0 and up to {:g} m", cell_m, cell_max_m));
    return {};
}

/// Adds a row of the file to the heights, which it fills from its back: the file begins in the north.
Result<void> read_heights(const std::vector<std::string_view>& words, const GridHeader& header, const GridLines& lines,
                          double landing_m, double* heights_m) {
    const auto columns = static_cast<std::size_t>(*header[GridKey::columns]);
    if (words.size() != columns) return lines.error(fmt::format("{} heights, ncols says {}", words.size(), columns));
    const auto none = [&](std::size_t column) {
        return lines.error(
            fmt::format("column {} has no height ({}): fill the grid or crop it", column + 1, words[column]));
    };
    for (std::size_t column = 0; column < columns; ++column) {
        const auto value = finite_number(words[column]);
        if (!value && is_nan(words[column])) return none(column);
        if (!value) return lines.error(fmt::format("'{}' is no number", words[column]));
        if (header[GridKey::none] && *value == *header[GridKey::none]) return none(column);
        heights_m[column] = std::round((*value - landing_m) * to_mm) / to_mm + 0.0;
        if (!(std::abs(heights_m[column]) <= height_max_m))
            return lines.error(
                fmt::format("column {} lies {:g} m from the landing radius, more than {:g}: other units, "
                            "another zero (grid_landing_m), or a value for none without NODATA_value?",
                            column + 1, heights_m[column], height_max_m));
    }
    return {};
}

/// @param line_of  of a row from the south
template <typename LineOf>
Result<void> check_steps(const std::vector<double>& heights_m, std::size_t columns, std::size_t rows, double cell_m,
                         const LineOf& line_of) {
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
            for (const auto& [to_column, to_row] : {std::pair{column + 1, row}, std::pair{column, row + 1}}) {
                if (to_column >= columns || to_row >= rows) continue;
                const double step_m = heights_m[to_row * columns + to_column] - heights_m[row * columns + column];
                if (std::abs(step_m) > steepest_step * cell_m)
                    return Error{
                        fmt::format("line {}: beside column {} the ground steps by {:g} m within {:g} m: other "
                                    "units, or a value for none without NODATA_value?",
                                    line_of(row), column + 1, step_m, cell_m)};
            }
    return {};
}

}  // namespace

Result<simulation::HeightGrid> height_grid_from_text(std::string_view text, const GridDatum& datum) {
    GridLines lines{text};
    GridHeader header;
    auto words = lines.next();
    for (; !words.empty() && !finite_number(words.front()) && !is_nan(words.front()); words = lines.next()) {
        const auto key = grid_key_of(words.front());
        if (!key)
            return lines.error(fmt::format("'{}' is none of ncols, nrows, xllcorner, xllcenter, yllcorner, yllcenter, "
                                           "cellsize, NODATA_value",
                                           words.front()));
        auto& value = header.values.at(*key);
        if (value) return lines.error(fmt::format("{} is said twice", words.front()));
        if (words.size() == 2) value = finite_number(words[1]);
        if (*key == static_cast<std::size_t>(GridKey::none) && words.size() == 2 && is_nan(words[1])) continue;
        if (!value) return lines.error(fmt::format("{} is followed by no number", words.front()));
    }
    if (const auto whole = check_header(header, lines); !whole) return whole.error();

    simulation::HeightGrid::Shape shape;
    shape.columns = static_cast<std::size_t>(*header[GridKey::columns]);
    shape.rows = static_cast<std::size_t>(*header[GridKey::rows]);
    shape.cell_m = *header[GridKey::cell];
    const double half_m = 0.5 * shape.cell_m;
    shape.west_m = (header[GridKey::x_center] ? *header[GridKey::x_center] : *header[GridKey::x_corner] + half_m) -
                   datum.target_x_m;
    shape.south_m = (header[GridKey::y_center] ? *header[GridKey::y_center] : *header[GridKey::y_corner] + half_m) -
                    datum.target_y_m;

    std::vector<double> heights_m(shape.columns * shape.rows);
    std::vector<std::size_t> line_numbers(shape.rows);
    for (std::size_t row = shape.rows; row-- > 0; words = lines.next()) {
        if (words.empty())
            return lines.error(
                fmt::format("the grid ends after {} rows, nrows says {}", shape.rows - row - 1, shape.rows));
        line_numbers[row] = lines.number();
        if (const auto done = read_heights(words, header, lines, datum.landing_m, &heights_m[row * shape.columns]);
            !done)
            return done.error();
    }
    if (!words.empty()) return lines.error(fmt::format("more rows than the {} that nrows says", shape.rows));
    if (const auto even = check_steps(heights_m, shape.columns, shape.rows, shape.cell_m,
                                      [&](std::size_t row) { return line_numbers[row]; });
        !even)
        return even.error();
    return simulation::HeightGrid{shape, std::move(heights_m)};
}

std::string grid_text(const simulation::HeightGrid& grid) {
    const auto& shape = grid.shape();
    std::string text = fmt::format("ncols {}\nnrows {}\nxllcenter {}\nyllcenter {}\ncellsize {}\n", shape.columns,
                                   shape.rows, shape.west_m, shape.south_m, shape.cell_m);
    for (std::size_t row = shape.rows; row-- > 0;)
        for (std::size_t column = 0; column < shape.columns; ++column)
            fmt::format_to(std::back_inserter(text), "{}{}", grid.at_node(column, row),
                           column + 1 == shape.columns ? '\n' : ' ');
    return text;
}

Result<simulation::HeightGrid> height_grid_from_file(const std::filesystem::path& file, const GridDatum& datum) {
    const auto text = bounded_text(file, grid_octets_max, "grid");
    if (!text) return text.error();
    auto grid = height_grid_from_text(*text, datum);
    if (grid) return grid;
    const std::string& why = grid.error().message;
    constexpr std::string_view line = "line ";
    return Error{file.string() + ":" + (why.starts_with(line) ? why.substr(line.size()) : " " + why)};
}

}  // namespace aeolis::server
