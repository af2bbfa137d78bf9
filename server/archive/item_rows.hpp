// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/item_tables.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/sqlite.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

// Converts records to rows and back from the description of their kind: SQL, binding, reading.
namespace aeolis::archive {

/// How a value is stored in a column: SQL type, whether it may be NULL, binding and reading.
template <typename Value>
struct ColumnType;

template <typename Value>
    requires std::is_integral_v<Value> || (std::is_enum_v<Value> && !requires { EnumWords<Value>::count; })
struct ColumnType<Value> {
    static constexpr char type[] = "INTEGER";
    static constexpr bool nullable = false;
    static void bind(sqlite::Statement& row, int parameter, Value value) {
        row.bind(parameter, static_cast<std::int64_t>(value));
    }
    static Value read(const sqlite::Statement& row, int column) { return static_cast<Value>(row.integer(column)); }
};

template <typename Value>
    requires requires { EnumWords<Value>::count; }
struct ColumnType<Value> {
    static constexpr char type[] = "TEXT";
    static constexpr bool nullable = false;
    static void bind(sqlite::Statement& row, int parameter, Value value) {
        row.bind(parameter, std::string_view(EnumWords<Value>::of(value)));
    }
    static Value read(const sqlite::Statement& row, int column) {
        std::size_t value = 0;
        while (value + 1 < EnumWords<Value>::count &&
               row.text(column) != EnumWords<Value>::of(static_cast<Value>(value)))
            ++value;
        return static_cast<Value>(value);
    }
    /// A constraint that admits only these words.
    static std::string check(const char* name) {
        std::string words;
        for (std::size_t value = 0; value < EnumWords<Value>::count; ++value)
            words += (value == 0 ? "'" : ", '") + std::string(EnumWords<Value>::of(static_cast<Value>(value))) + "'";
        return std::string(" CHECK (") + name + " IN (" + words + "))";
    }
};

template <typename Tag, typename Number>
struct ColumnType<Id<Tag, Number>> : ColumnType<Number> {
    static void bind(sqlite::Statement& row, int parameter, Id<Tag, Number> id) {
        ColumnType<Number>::bind(row, parameter, id.value);
    }
    static Id<Tag, Number> read(const sqlite::Statement& row, int column) {
        return {ColumnType<Number>::read(row, column)};
    }
};

template <>
struct ColumnType<Ert> : ColumnType<std::int64_t> {
    static void bind(sqlite::Statement& row, int parameter, Ert ert) { row.bind(parameter, ert.microseconds); }
    static Ert read(const sqlite::Statement& row, int column) { return {row.integer(column)}; }
};

/// A double. SQLite stores NaN as NULL.
template <>
struct ColumnType<double> {
    static constexpr char type[] = "REAL";
    static constexpr bool nullable = false;
    static void bind(sqlite::Statement& row, int parameter, double value) { row.bind(parameter, value); }
    static double read(const sqlite::Statement& row, int column) {
        return row.is_null(column) ? std::numeric_limits<double>::quiet_NaN() : row.real(column);
    }
};

template <>
struct ColumnType<Sclk> : ColumnType<double> {
    static void bind(sqlite::Statement& row, int parameter, Sclk sclk) { row.bind(parameter, sclk.seconds); }
    static Sclk read(const sqlite::Statement& row, int column) { return {row.real(column)}; }
};

template <>
struct ColumnType<std::string> {
    static constexpr char type[] = "TEXT";
    static constexpr bool nullable = false;
    static void bind(sqlite::Statement& row, int parameter, const std::string& text) {
        row.bind(parameter, std::string_view(text));
    }
    static std::string read(const sqlite::Statement& row, int column) { return std::string(row.text(column)); }
};

template <>
struct ColumnType<std::vector<std::uint8_t>> {
    static constexpr char type[] = "BLOB";
    static constexpr bool nullable = false;
    static void bind(sqlite::Statement& row, int parameter, std::span<const std::uint8_t> octets) {
        row.bind_octets(parameter, octets);
    }
    static std::vector<std::uint8_t> read(const sqlite::Statement& row, int column) {
        const auto octets = row.octets(column);
        return {octets.begin(), octets.end()};
    }
};

template <std::size_t count>
struct ColumnType<std::array<std::uint8_t, count>> : ColumnType<std::vector<std::uint8_t>> {
    static std::array<std::uint8_t, count> read(const sqlite::Statement& row, int column) {
        std::array<std::uint8_t, count> octets{};
        const auto stored = row.octets(column);
        std::ranges::copy(stored.first(std::min(count, stored.size())), octets.begin());
        return octets;
    }
    static std::string check(const char* name) {
        return std::string(" CHECK (length(") + name + ") = " + std::to_string(count) + ")";
    }
};

template <typename Value>
struct ColumnType<std::optional<Value>> : ColumnType<Value> {
    static constexpr bool nullable = true;
    static void bind(sqlite::Statement& row, int parameter, const std::optional<Value>& value) {
        if (value)
            ColumnType<Value>::bind(row, parameter, *value);
        else
            row.bind_null(parameter);
    }
    static std::optional<Value> read(const sqlite::Statement& row, int column) {
        if (row.is_null(column)) return {};
        return ColumnType<Value>::read(row, column);
    }
};

struct ColumnText {
    std::string name;
    std::string declared;  ///< in CREATE TABLE
    std::string selected;  ///< in SELECT
    bool searched = false;
};

/// Visitor that collects the columns as SQL.
struct DescribeColumns {
    std::vector<ColumnText> columns;

    void add(const char* name, const char* type, bool nullable, bool searched = false) {
        columns.push_back({name, std::string(name) + ' ' + type + (nullable ? "" : " NOT NULL"), name, searched});
    }
    template <typename Value>
    void operator()(const char* name, const Value&, Column column = Column::plain) {
        add(name, ColumnType<Value>::type, ColumnType<Value>::nullable || column == Column::optional,
            column == Column::searched);
        if constexpr (requires { ColumnType<Value>::check(name); })
            columns.back().declared += ColumnType<Value>::check(name);
    }
    void operator()(const char* name, OfRun) { add(name, "INTEGER", false); }
    void operator()(const char* name, const Slice&) { add(name, "BLOB", false); }
    template <typename Text>
    void operator()(const char* name, LinkName<Text>) {
        add(name, "INTEGER", false);
        columns.back().selected = std::string("(SELECT word FROM words WHERE kind = 'link' AND number = ") + name + ")";
    }
};

/// Visitor that binds a record's values to a statement's parameters.
struct BindColumns {
    sqlite::Statement& row;
    int parameter = 1;
    RunId run{};
    std::span<const std::uint8_t> batch_octets{};
    std::int64_t link = 0;  ///< the link's number

    template <typename Value>
    void operator()(const char*, const Value& value, Column column = Column::plain) {
        if constexpr (requires { value.empty(); })
            if (column == Column::optional && value.empty()) {
                row.bind_null(parameter++);
                return;
            }
        ColumnType<Value>::bind(row, parameter++, value);
    }
    void operator()(const char*, OfRun) { row.bind(parameter++, std::int64_t{run.value}); }
    void operator()(const char*, const Slice& octets) {
        row.bind_octets(parameter++, batch_octets.subspan(octets.first, octets.count));
    }
    template <typename Text>
    void operator()(const char*, LinkName<Text>) {
        row.bind(parameter++, link);
    }
};

/// Visitor that reads a row's columns into a record. A packet's octets stay in the row; only their count is read.
struct ReadColumns {
    const sqlite::Statement& row;
    int column = 0;

    template <typename Value>
    void operator()(const char*, Value& value, Column = Column::plain) {
        value = ColumnType<Value>::read(row, column++);
    }
    void operator()(const char*, OfRun) { ++column; }
    void operator()(const char*, Slice& octets) { octets = {0, row.octets(column++).size()}; }
    void operator()(const char*, LinkName<std::string> link) { link.name = row.text(column++); }
};

template <template <typename> typename Table, typename Record>
std::vector<ColumnText> columns_of() {
    const Record record{};
    DescribeColumns describe;
    Table<Record>::columns(record, describe);
    return std::move(describe.columns);
}

template <typename Record>
bool is_searched() {
    static const bool searched = std::ranges::any_of(columns_of<ItemTable, Record>(), &ColumnText::searched);
    return searched;
}

/// The given text of all columns, separated by `between`.
std::string joined(const std::vector<ColumnText>& columns, std::string ColumnText::* text, const char* between);

/// SQL for read_row(): "SELECT key, ert_us, … FROM `schema`TABLE WHERE `where` ORDER BY key LIMIT ?3".
template <typename Record>
std::string select_sql(const std::string& where, const std::string& schema = {}, Order order = {}) {
    return "SELECT key, ert_us, " + joined(columns_of<ItemTable, Record>(), &ColumnText::selected, ", ") + " FROM " +
           schema + ItemTable<Record>::name + " WHERE " + where + " ORDER BY key" +
           (order == Order::newest_first ? " DESC" : "") + " LIMIT ?3";
}
/// A text in both orders. Static storage: State::query() knows a text by its address.
struct SqlInOrder {
    std::string oldest_first, newest_first;
    const char* in(Order order) const {
        return order == Order::newest_first ? newest_first.c_str() : oldest_first.c_str();
    }
};
template <typename Record>
SqlInOrder select_in_order(const std::string& where) {
    return {select_sql<Record>(where), select_sql<Record>(where, {}, Order::newest_first)};
}
/// SQL for the rows with keys ?1 to ?2, at most ?3, in order. Static storage, as for all these functions.
template <typename Record>
const char* rows_sql(Order order = {}) {
    static const auto sql = select_in_order<Record>("key BETWEEN ?1 AND ?2");
    return sql.in(order);
}
/// SQL for those of these rows that contain the words ?4.
template <typename Record>
const char* found_rows_sql(Order order = {}) {
    static const auto sql =
        select_in_order<Record>("key IN (SELECT rowid FROM search WHERE search MATCH ?4 AND rowid BETWEEN ?1 AND ?2)");
    return sql.in(order);
}
/// SQL for the parts of the item with key ?1, in order.
template <typename Part>
const char* parts_sql() {
    static const std::string sql = "SELECT " + joined(columns_of<PartTable, Part>(), &ColumnText::selected, ", ") +
                                   " FROM " + PartTable<Part>::name + " WHERE key = ?1 ORDER BY position";
    return sql.c_str();
}

/// Reads a record without its parts, which have rows of their own.
template <typename Record>
Record read_row(const sqlite::Statement& row) {
    Record record;
    record.seq = sequence_of(row.integer(0));
    record.ert = ColumnType<Ert>::read(row, 1);
    ItemTable<Record>::columns(record, ReadColumns{row, 2});
    return record;
}
template <typename Part>
Part read_part(const sqlite::Statement& row) {
    Part part;
    PartTable<Part>::columns(part, ReadColumns{row});
    return part;
}
/// The octets of the packet in the current row.
std::span<const std::uint8_t> octets_of_packet(const sqlite::Statement& row);

}  // namespace aeolis::archive
