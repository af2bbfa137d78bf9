// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fields.hpp"
#include "common/fixed_vector.hpp"

#include <array>
#include <optional>
#include <type_traits>
#include <variant>

namespace aeolis::flight {

template <typename T, std::size_t N>
constexpr void expect_only_data(std::array<T, N>& values);
template <typename T, std::size_t N>
constexpr void expect_only_data(FixedVector<T, N>& values);
template <typename T>
constexpr void expect_only_data(std::optional<T>& value);

/// Does not compile when there is a pointer or a view anywhere in a T, through which the receiver would read memory
/// that the sender has changed since. Fields are found from the type, those of a class with private state by its
/// carry(). R3
template <typename T>
constexpr void expect_only_data(T& value) {
    static_assert(std::is_trivially_copyable_v<T>, "what a message holds is copied octet by octet");
    static_assert(!std::is_pointer_v<T> && !std::is_member_pointer_v<T>, "a message holds a pointer");
    if constexpr (std::is_class_v<T>) {
        const auto each = [](auto&... fields) { (expect_only_data(fields), ...); };
        if constexpr (std::is_aggregate_v<T>)
            with_fields(value, each);
        else
            value.carry(each);  // a view has none
    }
}
template <typename T, std::size_t N>
constexpr void expect_only_data(std::array<T, N>& values) {
    expect_only_data(values.front());
}
template <typename T, std::size_t N>
constexpr void expect_only_data(FixedVector<T, N>& values) {
    expect_only_data(values[0]);
}
template <typename T>
constexpr void expect_only_data(std::optional<T>& value) {
    expect_only_data(*value);
}
template <typename... T>
constexpr void expect_only_data_in_each(std::variant<T...>& value) {
    (expect_only_data(std::get<T>(value)), ...);
}

}  // namespace aeolis::flight
