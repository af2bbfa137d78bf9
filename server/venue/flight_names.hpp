// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"

#include <array>
#include <string_view>
#include <utility>
#include <variant>

// The names of modules and messages in reports: those of the source code, as given by the compiler. R40
namespace aeolis::server {

namespace name_detail {

/// The last word of the template argument in a compiler's function signature.
constexpr std::string_view argument_in(std::string_view signature) {
    signature = signature.substr(signature.find(" = ") + 3);
    signature = signature.substr(0, signature.find_first_of(";]"));
    return signature.substr(signature.rfind(':') + 1);  // npos + 1 is 0: the whole text
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

/// The names of messages, by index in flight::Message.
inline constexpr auto message_names = name_detail::message_names(std::make_index_sequence<message_type_count>{});
/// The names of modules, by flight::ModuleId.
inline constexpr auto module_names = name_detail::module_names(std::make_index_sequence<flight::module_count>{});

constexpr std::string_view name_of(flight::ModuleId id) {
    return module_names[static_cast<std::size_t>(id)];
}

}  // namespace aeolis::server
