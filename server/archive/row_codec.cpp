// SPDX-License-Identifier: Apache-2.0
#include "server/archive/row_codec.hpp"

#include <bit>
#include <charconv>
#include <optional>
#include <vector>

namespace aeolis::archive {
namespace {

Error no_octets_of_a_row() {
    return Error{"these are no octets of a row"};
}

template <typename Number>
std::optional<Number> number_in(std::string_view digits) {
    Number number{};
    const auto* const end = digits.data() + digits.size();
    const auto [stopped, error] = std::from_chars(digits.data(), end, number);
    if (error != std::errc{} || stopped != end) return std::nullopt;
    return number;
}

}  // namespace

void append_row(const sqlite::Statement& row, std::string& octets) {
    std::vector<std::uint8_t> exact;
    for (int column = 0; column < row.columns(); ++column) row.append_exact(column, exact);
    octets.append(exact.begin(), exact.end());
}

Result<void> RowOctets::bind(sqlite::Statement& statement, int parameter, std::int64_t* integer) {
    if (integer != nullptr) *integer = -1;
    const auto colon = rest_.find(':');
    if (colon == std::string_view::npos || colon == 0) return no_octets_of_a_row();
    const char type = rest_.front();
    const auto size = number_in<std::size_t>(rest_.substr(1, colon - 1));
    if (!size || *size > rest_.size() - colon - 1) return no_octets_of_a_row();
    const auto value = rest_.substr(colon + 1, *size);
    rest_.remove_prefix(colon + 1 + *size);
    switch (type) {
    case 'n': statement.bind_null(parameter); return {};
    case 'i': {
        const auto number = number_in<std::int64_t>(value);
        if (!number) return no_octets_of_a_row();
        statement.bind(parameter, *number);
        if (integer != nullptr) *integer = *number;
        return {};
    }
    case 'r': {
        const auto bits = number_in<std::uint64_t>(value);
        if (!bits) return no_octets_of_a_row();
        statement.bind(parameter, std::bit_cast<double>(*bits));
        return {};
    }
    case 't': statement.bind(parameter, value); return {};
    case 'b':
        statement.bind_octets(parameter, {reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
        return {};
    default: return no_octets_of_a_row();
    }
}

}  // namespace aeolis::archive
