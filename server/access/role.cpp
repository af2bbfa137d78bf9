// SPDX-License-Identifier: Apache-2.0
#include "server/access/role.hpp"

#include <algorithm>

namespace aeolis::server {

std::string_view name_of(Role role) {
    constexpr std::array<std::string_view, roles.size()> names{"observer", "controller", "director", "instructor",
                                                               "administrator"};
    return names[static_cast<std::size_t>(role)];
}

std::string_view name_of(Right right) {
    constexpr std::array<std::string_view, rights.size()> names{"open",     "watch",    "command",   "hazardous",
                                                                "rehearse", "instruct", "administer"};
    return names[static_cast<std::size_t>(right)];
}

std::optional<Role> role_of(std::string_view name) {
    const auto* const found = std::ranges::find(roles, name, [](Role role) { return name_of(role); });
    return found == roles.end() ? std::nullopt : std::optional{*found};
}

std::optional<Role> least_role(Right right) {
    switch (right) {
    case Right::open: return std::nullopt;
    case Right::watch: return Role::observer;
    case Right::command: return Role::controller;
    case Right::hazardous:
    case Right::rehearse: return Role::director;
    case Right::instruct: return Role::instructor;
    case Right::administer: break;
    }
    return Role::administrator;
}

bool may(Role role, Right right) {
    const auto least = least_role(right);
    return !least || role >= *least;
}

bool may(const Operator& who, Right right) {
    if (right == Right::open) return true;
    return who.role && !who.choose_password && may(*who.role, right);
}

}  // namespace aeolis::server
