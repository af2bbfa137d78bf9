// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/time.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

// Transfer of a module's state between computers.
// Each class lists in `carry(exchange)` the values that the other computer needs; the same line writes and reads them.
// R33
namespace aeolis::flight {

/// Writes or reads values one after another, in the processor's representation.
/// Both computers are of the same type and run the same build, which the frame around the state checks. Past the end
/// nothing is written or read, and ok() is false.
template <typename Octet>
class StateExchange {
  public:
    static constexpr bool writing = !std::is_const_v<Octet>;

    explicit StateExchange(std::span<Octet> octets) : octets_(octets) {}

    template <typename... Values>
    void operator()(Values&... values) {
        (carry(values), ...);
    }

    /// Values whose defaults both computers have: a bit for each that departs from its own, then those that do. Equal
    /// are numbers of the same bits. `value_at(i)` gives a reference, `default_at(i)` a value.
    template <typename ValueAt, typename DefaultAt>
    void departures(std::size_t count, const ValueAt& value_at, const DefaultAt& default_at) {
        for (std::size_t first = 0; first < count; first += word_bits) {
            const std::size_t in_word = std::min(word_bits, count - first);
            std::uint64_t departed = 0;
            if constexpr (writing)
                for (std::size_t i = 0; i < in_word; ++i)
                    departed |= std::uint64_t{!same(value_at(first + i), default_at(first + i))} << i;
            number(departed);
            if (in_word < word_bits && departed >> in_word != 0) {
                ok_ = false;
                return;
            }
            if constexpr (!writing)
                for (std::size_t i = 0; i < in_word; ++i) value_at(first + i) = default_at(first + i);
            for (; departed != 0; departed &= departed - 1)
                carry(value_at(first + static_cast<std::size_t>(std::countr_zero(departed))));
        }
    }
    /// The same of a table of nothing but doubles.
    template <typename Table>
    void departures(Table& table, const Table& defaults) {
        static_assert(std::is_trivially_copyable_v<Table> && sizeof(Table) % sizeof(double) == 0);
        using Doubles = std::array<double, sizeof(Table) / sizeof(double)>;
        auto values = std::bit_cast<Doubles>(table);
        const auto default_values = std::bit_cast<Doubles>(defaults);
        departures(
            values.size(), [&](std::size_t i) -> double& { return values[i]; },
            [&](std::size_t i) { return default_values[i]; });
        if constexpr (!writing) table = std::bit_cast<Table>(values);
    }

    bool ok() const { return ok_; }
    std::size_t size() const { return at_; }

  private:
    static constexpr std::size_t word_bits = 64;

    static bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
    static bool same(const std::optional<double>& a, const std::optional<double>& b) {
        return a.has_value() == b.has_value() && (!a || same(*a, *b));
    }
    static bool same(const MaybeTime& a, const MaybeTime& b) {
        return a.defined() == b.defined() && (!a.defined() || same(a.get()->seconds, b.get()->seconds));
    }

    template <typename T>
    void carry(T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
            number(value);
        else if constexpr (requires { value.carry(*this); })
            value.carry(*this);
        else if constexpr (requires { value.coeffs(); })  // Eigen's quaternion
            carry(value.coeffs());
        else if constexpr (requires { value.derived(); })  // Eigen's vectors
            numbers(value.data(), static_cast<std::size_t>(value.size()));
        else if constexpr (requires { value.seconds; })
            number(value.seconds);
        else
            number(value.value);
    }
    template <typename T, std::size_t N>
    void carry(std::array<T, N>& values) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
            numbers(values.data(), N);
        else
            for (T& value : values) carry(value);
    }
    /// Only the values that are there.
    template <typename T, std::size_t N>
    void carry(FixedVector<T, N>& values) {
        static_assert(N <= std::numeric_limits<std::uint8_t>::max());
        auto count = static_cast<std::uint8_t>(values.size());
        number(count);
        if (count > N) {
            ok_ = false;
            return;
        }
        values.resize(count);
        for (T& value : values) carry(value);
    }
    template <typename T>
    void carry(std::optional<T>& value) {
        bool present = value.has_value();
        number(present);
        T content = value.value_or(T{});
        if (present) carry(content);
        if constexpr (!writing) value = present ? std::optional{content} : std::nullopt;
    }
    void carry(MaybeTime& time) {
        std::optional<Sclk> content = time.get();
        carry(content);
        if (!writing) time = content ? MaybeTime{*content} : MaybeTime{};
    }

    template <typename T>
    void number(T& value) {
        numbers(&value, 1);
    }
    template <typename T>
    void numbers(T* values, std::size_t count) {
        const std::size_t size = count * sizeof(T);
        if (at_ + size > octets_.size()) {
            ok_ = false;
            return;
        }
        if constexpr (writing)
            std::memcpy(octets_.data() + at_, values, size);
        else
            std::memcpy(values, octets_.data() + at_, size);
        at_ += size;
    }

    std::span<Octet> octets_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace aeolis::flight
