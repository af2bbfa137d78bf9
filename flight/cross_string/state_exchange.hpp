// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <array>
#include <cstdint>
#include <cstring>
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
            for (int i = 0; i < value.size(); ++i) number(value.data()[i]);
        else if constexpr (requires { value.seconds; })
            number(value.seconds);
        else
            number(value.value);
    }
    template <typename T, std::size_t N>
    void carry(std::array<T, N>& values) {
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
        if (at_ + sizeof value > octets_.size()) {
            ok_ = false;
            return;
        }
        // -fno-builtin would turn each of these into a call; there are some hundred a cycle.
        if constexpr (writing)
            __builtin_memcpy(octets_.data() + at_, &value, sizeof value);
        else
            __builtin_memcpy(&value, octets_.data() + at_, sizeof value);
        at_ += sizeof value;
    }

    std::span<Octet> octets_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace aeolis::flight
