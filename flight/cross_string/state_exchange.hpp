// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/time.hpp"

#include <array>
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

    /// A table of nothing but doubles, whole.
    template <typename Table>
    void doubles(Table& table) {
        static_assert(std::is_trivially_copyable_v<Table> && alignof(Table) == alignof(double));
        numbers(&table, 1);
    }

    bool ok() const { return ok_; }
    std::size_t size() const { return at_; }

  private:
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
        carry(content);
        if (!writing) value = present ? std::optional{content} : std::nullopt;
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
