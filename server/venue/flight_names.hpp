// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"

#include <array>
#include <string_view>
#include <utility>
#include <variant>

// What modules and messages are called in reports: their names in the source, as the compiler knows them. R40
namespace aeolis::server {

namespace name_detail {

/// The last word of what the compiler calls its template argument.
constexpr std::string_view argument_in(std::string_view signature) {
    signature = signature.substr(signature.find(" = ") + 3);
    signature = signature.substr(0, signature.find_first_of(";]"));
    return signature.substr(signature.rfind(':') + 1);  // all of it where there is none
}
template <typename Message>
constexpr std::string_view type_name() {
    return argument_in(__PRETTY_FUNCTION__);
}
template <flight::ModuleId id>
constexpr std::string_view module_name() {
    return argument_in(__PRETTY_FUNCTION__);
}
template <std::size_t... I>
constexpr std::array<std::string_view, sizeof...(I)> message_names(std::index_sequence<I...>) {
    return {type_name<std::variant_alternative_t<I, flight::Message>>()...};
}
template <std::size_t... I>
constexpr std::array<std::string_view, sizeof...(I)> module_names(std::index_sequence<I...>) {
    return {module_name<static_cast<flight::ModuleId>(I)>()...};
}

}  // namespace name_detail

inline constexpr std::size_t message_type_count = std::variant_size_v<flight::Message>;

/// By flight::Message's index.
inline constexpr auto message_names = name_detail::message_names(std::make_index_sequence<message_type_count>{});
/// By flight::ModuleId.
inline constexpr auto module_names = name_detail::module_names(std::make_index_sequence<flight::module_count>{});

constexpr std::string_view name_of(flight::ModuleId id) {
    return module_names[static_cast<std::size_t>(id)];
}

}  // namespace aeolis::server
