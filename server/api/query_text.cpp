// SPDX-License-Identifier: Apache-2.0
#include "server/api/query_text.hpp"

#include <algorithm>
#include <boost/url/encoding_opts.hpp>
#include <boost/url/parse_query.hpp>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aeolis::server {

Result<QueryText> QueryText::parse(std::string_view encoded, const std::vector<std::string_view>& known) {
    QueryText query;
    const std::string text{encoded};  // Boost.URL 1.81 reads one octet beyond an empty view
    const auto parsed = boost::urls::parse_query(text);
    if (!parsed) return Error{fmt::format("the query '{}' is not well formed", encoded)};
    const boost::urls::encoding_opts plus_is_space{true};
    for (const auto part : *parsed) {
        const auto name = boost::urls::pct_string_view{part.key}.decode(plus_is_space);
        if (name.empty() && !part.has_value) continue;
        if (std::ranges::find(known, name) == known.end()) {
            std::string names;
            for (const auto each : known) names += (names.empty() ? "" : ", ") + std::string{each};
            return Error{fmt::format("unknown parameter '{}'; known here: {}", name, names.empty() ? "none" : names)};
        }
        if (query.text(name)) return Error{fmt::format("parameter '{}' is given twice", name)};
        query.values_.emplace_back(name, boost::urls::pct_string_view{part.value}.decode(plus_is_space));
    }
    return query;
}

std::optional<std::string> QueryText::text(std::string_view name) const {
    for (const auto& [known, value] : values_)
        if (known == name) return value;
    return std::nullopt;
}

Result<std::optional<double>> QueryText::number(std::string_view name) const {
    const auto given = text(name);
    if (!given || given->empty()) return std::optional<double>{};
    double value = 0.0;
    const auto [end, error] = std::from_chars(given->data(), given->data() + given->size(), value);
    if (error != std::errc{} || end != given->data() + given->size() || !std::isfinite(value))
        return Error{fmt::format("{}: '{}' is not a number", name, *given)};
    return std::optional{value};
}

Result<std::optional<std::uint64_t>> QueryText::count(std::string_view name, std::uint64_t max) const {
    const auto given = text(name);
    if (!given || given->empty()) return std::optional<std::uint64_t>{};
    std::string_view digits = *given;
    const bool hexadecimal = digits.starts_with("0x");
    if (hexadecimal) digits.remove_prefix(2);
    std::uint64_t value = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
    if (error != std::errc{} || end != digits.data() + digits.size())
        return Error{fmt::format("{}: '{}' is not a whole number from 0", name, *given)};
    if (value > max) return Error{fmt::format("{}: {} is more than {}", name, value, max)};
    return std::optional{value};
}

Result<std::optional<std::uint64_t>> QueryText::amount(std::string_view name, std::uint64_t max) const {
    auto value = count(name, max);
    if (value && *value && **value == 0) return Error{fmt::format("{}: 0 asks for nothing", name)};
    return value;
}

Result<std::string> QueryText::one_of(std::string_view name, std::span<const std::string_view> words) const {
    auto word = text(name);
    if (!word) return std::string{words.front()};
    if (std::ranges::find(words, *word) != words.end()) return std::move(*word);
    return Error{fmt::format("{}: '{}' is none of {}", name, *word, fmt::join(words, ", "))};
}

std::vector<std::string> QueryText::list(std::string_view name) const {
    std::vector<std::string> values;
    auto rest = text(name).value_or("");
    while (!rest.empty()) {
        const auto comma = rest.find(',');
        if (comma != 0) values.push_back(rest.substr(0, comma));
        rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
    }
    return values;
}

}  // namespace aeolis::server
