// SPDX-License-Identifier: Apache-2.0
#include "server/archive/layouts.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::archive {
namespace {

constexpr char first_printable = '!', last_printable = '~';

bool is_letter_or_digit(char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9');
}

}  // namespace

Result<void> check_layout_name(const std::string& name) {
    const auto allowed = [](char letter) {
        return is_letter_or_digit(letter) || letter == ' ' || letter == '-' || letter == '_' || letter == '.';
    };
    if (!name.empty() && name.size() <= layout_name_octets_max && std::ranges::all_of(name, allowed) &&
        is_letter_or_digit(name.front()) && is_letter_or_digit(name.back()))
        return {};
    return Error{fmt::format("name: 1 to {} of letters, digits, blank, '-', '_' and '.', with a letter or digit at "
                             "either end",
                             layout_name_octets_max)};
}

Result<void> check_layout_view(const std::string& view) {
    if (view.size() > layout_view_octets_max)
        return Error{fmt::format("view: {} octets, at most {}", view.size(), layout_view_octets_max)};
    const auto printable = [](char letter) { return letter >= first_printable && letter <= last_printable; };
    if (!std::ranges::all_of(view, printable))
        return Error{"view: the query of an address, percent-encoded: printable ASCII without blanks"};
    return {};
}

Result<LayoutOutcome> change_layout(sqlite::Database& database, const LayoutChange& change) {
    if (!change.view) {
        auto removed = database.prepare("DELETE FROM layouts WHERE owner = ?1 AND name = ?2 RETURNING name");
        if (!removed) return removed.error();
        removed->bind(1, std::string_view(change.owner)).bind(2, std::string_view(change.name));
        auto found = removed->step();
        if (!found) return found.error();
        removed->reset();
        return *found ? LayoutOutcome::done : LayoutOutcome::absent;
    }
    auto others = database.prepare("SELECT count(*) FROM layouts WHERE owner = ?1 AND name <> ?2");
    if (!others) return others.error();
    others->bind(1, std::string_view(change.owner)).bind(2, std::string_view(change.name));
    auto counted = others->step();
    if (!counted) return counted.error();
    if (others->integer(0) >= static_cast<std::int64_t>(layouts_max)) return LayoutOutcome::full;
    others->reset();
    auto row = database.prepare("INSERT OR REPLACE INTO layouts VALUES (?,?,?,?)");
    if (!row) return row.error();
    row->bind(1, std::string_view(change.owner))
        .bind(2, std::string_view(change.name))
        .bind(3, std::string_view(*change.view))
        .bind(4, std::string_view(change.saved));
    if (auto done = row->run(); !done) return done.error();
    return LayoutOutcome::done;
}

Result<std::vector<LayoutRecord>> layouts_of(sqlite::Database& database, const std::string& owner) {
    auto rows = database.prepare("SELECT name, view, saved FROM layouts WHERE owner = ?1 ORDER BY saved, name");
    if (!rows) return rows.error();
    rows->bind(1, std::string_view(owner));
    std::vector<LayoutRecord> layouts;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return layouts;
        layouts.push_back({std::string(rows->text(0)), std::string(rows->text(1)), std::string(rows->text(2))});
    }
}

}  // namespace aeolis::archive
