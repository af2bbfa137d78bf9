// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

// The fields of an aggregate, derived from its type, so that a field added later is not forgotten.
namespace aeolis {

/// Converts to any type: counts the initialisers of an aggregate.
struct AnyField {
    template <typename T>
    operator T() const;
};

template <typename T, std::size_t... I>
constexpr bool takes_fields(std::index_sequence<I...>) {
    return requires { T{(static_cast<void>(I), AnyField{})...}; };
}
inline constexpr std::size_t field_count_max = 24;

/// The number of fields of an aggregate.
template <typename T, std::size_t N = field_count_max>
constexpr std::size_t field_count() {
    if constexpr (N == 0 || takes_fields<T>(std::make_index_sequence<N>{}))
        return N;
    else
        return field_count<T, N - 1>();
}

/// Calls `use` with all fields of an aggregate, in their order.
template <typename T, typename Use>
constexpr void with_fields(T& value, Use&& use) {
    constexpr std::size_t n = field_count<T>();
    // clang-format off
    if constexpr (n == 0) { use(); }
    else if constexpr (n == 1) { auto& [a] = value; use(a); }
    else if constexpr (n == 2) { auto& [a, b] = value; use(a, b); }
    else if constexpr (n == 3) { auto& [a, b, c] = value; use(a, b, c); }
    else if constexpr (n == 4) { auto& [a, b, c, d] = value; use(a, b, c, d); }
    else if constexpr (n == 5) { auto& [a, b, c, d, e] = value; use(a, b, c, d, e); }
    else if constexpr (n == 6) { auto& [a, b, c, d, e, f] = value; use(a, b, c, d, e, f); }
    else if constexpr (n == 7) { auto& [a, b, c, d, e, f, g] = value; use(a, b, c, d, e, f, g); }
    else if constexpr (n == 8) { auto& [a, b, c, d, e, f, g, h] = value; use(a, b, c, d, e, f, g, h); }
    else if constexpr (n == 9) { auto& [a, b, c, d, e, f, g, h, i] = value; use(a, b, c, d, e, f, g, h, i); }
    else if constexpr (n == 17) {
        auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r] = value;
        use(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r);
    }
    // clang-format on
    else
        static_assert(n == 0, "an aggregate with so many fields: add its line here");
}

}  // namespace aeolis
