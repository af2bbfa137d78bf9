// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fields.hpp"
#include "flight/kernel/message.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>

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
        with_fields(value, [&](auto&... fields) { fill_each(from, fields...); });
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
