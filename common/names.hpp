// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <string_view>

// Finds the name that a person may have meant by a misspelt one.
namespace aeolis {

inline constexpr std::size_t name_length_max = 63;

/// A name as a template argument, so that the compiler's error shows it.
struct Name {
    std::array<char, name_length_max + 1> text{};

    constexpr Name(std::string_view name) {  // NOLINT(google-explicit-constructor): action_named<"stop_uhf">()
        std::ranges::copy(name.substr(0, name_length_max), text.begin());
    }
    template <std::size_t size>
    constexpr Name(const char (&name)[size]) : Name{std::string_view{name, size - 1}} {}  // NOLINT
    constexpr std::string_view view() const { return text.data(); }
};

/// Number of letters to insert, delete or replace to turn one name into the other. Names are cut off after
/// name_length_max letters.
constexpr std::size_t edit_distance(std::string_view from, std::string_view to) {
    from = from.substr(0, name_length_max);
    to = to.substr(0, name_length_max);
    std::array<std::size_t, name_length_max + 1> row{};  // distances of the first letters of `from` to those of `to`
    for (std::size_t i = 0; i <= to.size(); ++i) row[i] = i;
    for (std::size_t i = 0; i < from.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t k = 0; k < to.size(); ++k) {
            const std::size_t replaced = diagonal + (from[i] == to[k] ? 0 : 1);
            diagonal = row[k + 1];
            row[k + 1] = std::min({replaced, row[k] + 1, diagonal + 1});
        }
    }
    return row[to.size()];
}

/// The name in `all` with the smallest edit distance to `name`; of several, the first. Empty when `all` is empty.
/// `name_of` gives the name of an element.
template <typename All, typename NameOf = std::identity>
constexpr std::string_view nearest(std::string_view name, const All& all, NameOf name_of = {}) {
    std::string_view best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const auto& each : all) {
        const std::string_view candidate = std::invoke(name_of, each);
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < least) best = candidate, least = distance;
    }
    return best;
}

}  // namespace aeolis
