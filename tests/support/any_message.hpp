// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

// Message values built from octets, a fuzzer's or random ones. The fields come from the type itself, so that a new
// field is filled too.
namespace aeolis::test {

/// A source of octets: the given ones, then zeros.
class Source {
  public:
    explicit Source(std::span<const std::uint8_t> octets) : rest_(octets) {}

    bool empty() const { return rest_.empty(); }
    template <typename T>
    T take() {
        T value{};
        const std::size_t size = std::min(sizeof(T), rest_.size());
        if (size > 0) std::memcpy(&value, rest_.data(), size);  // of no octets there is no address
        rest_ = rest_.subspan(size);
        return value;
    }

  private:
    std::span<const std::uint8_t> rest_;
};

/// Converts to any type: counts the initialisers of an aggregate.
struct AnyField {
    template <typename T>
    operator T() const;
};

template <typename T, std::size_t... I>
constexpr bool takes_fields(std::index_sequence<I...>) {
    return requires { T{(static_cast<void>(I), AnyField{})...}; };
}
/// The number of fields of an aggregate.
template <typename T, std::size_t N = 24>
constexpr std::size_t field_count() {
    if constexpr (N == 0 || takes_fields<T>(std::make_index_sequence<N>{}))
        return N;
    else
        return field_count<T, N - 1>();
}

template <typename T>
void fill(Source& from, T& value);

template <typename... Fields>
void fill_each(Source& from, Fields&... fields) {
    (fill(from, fields), ...);
}
template <typename T, std::size_t N>
void fill(Source& from, std::array<T, N>& values) {
    for (T& value : values) fill(from, value);
}
template <typename T, std::size_t N>
void fill(Source& from, FixedVector<T, N>& values) {
    values.clear();
    for (std::size_t count = from.take<std::uint8_t>() % (N + 1); count > 0; --count) {
        T value{};
        fill(from, value);
        values.push_back(value);
    }
}
template <typename T>
void fill(Source& from, std::optional<T>& value) {
    value.reset();
    if (from.take<std::uint8_t>() % 2 != 0) fill(from, value.emplace());
}
/// Limits times to what the clock can count, in 1/64 s: forty bits of ticks are five centuries. R21
inline void fill(Source& from, Sclk& time) {
    const auto low = from.take<std::uint32_t>();
    time = Sclk::from_ticks(std::int64_t{from.take<std::int8_t>()} * 0x100000000 + low);
}

/// Fills a class with private state through carry(), which the other computer uses too.
template <typename T>
void carry_into(Source& from, T& value) {
    const auto exchange = [&](auto&... fields) { (fill(from, fields), ...); };
    value.carry(exchange);
}

template <typename T>
void fill_fields(Source& from, T& value) {
    constexpr std::size_t n = field_count<T>();
    // clang-format off
    if constexpr (n == 0) { static_cast<void>(from); static_cast<void>(value); }
    else if constexpr (n == 1) { auto& [a] = value; fill_each(from, a); }
    else if constexpr (n == 2) { auto& [a, b] = value; fill_each(from, a, b); }
    else if constexpr (n == 3) { auto& [a, b, c] = value; fill_each(from, a, b, c); }
    else if constexpr (n == 4) { auto& [a, b, c, d] = value; fill_each(from, a, b, c, d); }
    else if constexpr (n == 5) { auto& [a, b, c, d, e] = value; fill_each(from, a, b, c, d, e); }
    else if constexpr (n == 6) { auto& [a, b, c, d, e, f] = value; fill_each(from, a, b, c, d, e, f); }
    else if constexpr (n == 7) { auto& [a, b, c, d, e, f, g] = value; fill_each(from, a, b, c, d, e, f, g); }
    else if constexpr (n == 8) { auto& [a, b, c, d, e, f, g, h] = value; fill_each(from, a, b, c, d, e, f, g, h); }
    else if constexpr (n == 9) { auto& [a, b, c, d, e, f, g, h, i] = value; fill_each(from, a, b, c, d, e, f, g, h, i); }
    else if constexpr (n == 17) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r] = value;
        fill_each(from, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r);
    }
    // clang-format on
    else
        static_assert(n == 0, "a message with so many fields: add its line here");
}

template <typename T>
void fill(Source& from, T& value) {
    if constexpr (std::is_same_v<T, bool>)
        value = from.take<std::uint8_t>() % 2 != 0;
    else if constexpr (std::is_enum_v<T>)
        value = static_cast<T>(from.take<std::underlying_type_t<T>>());
    else if constexpr (std::is_arithmetic_v<T>)
        value = from.take<T>();
    else if constexpr (!std::is_aggregate_v<T>)
        carry_into(from, value);
    else
        fill_fields(from, value);
}

/// A message of the variant's type at `index`.
template <std::size_t Index = 0>
flight::Message message_of(std::size_t index, Source& from) {
    if constexpr (Index + 1 < std::variant_size_v<flight::Message>)
        if (index != Index) return message_of<Index + 1>(index, from);
    std::variant_alternative_t<Index, flight::Message> content{};
    fill(from, content);
    return content;
}

}  // namespace aeolis::test
