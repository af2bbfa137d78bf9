// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// What somebody may be; each may do what the one before may, and more.
enum class Role : std::uint8_t { observer, controller, director, administrator };
inline constexpr std::array roles{Role::observer, Role::controller, Role::director, Role::administrator};

/// What a route, a message of the stream or a command asks for.
enum class Right : std::uint8_t {
    open,        ///< nothing: log-in itself, the console's files
    watch,       ///< see everything                                       observer
    command,     ///< send commands, acknowledge alarms, write notes       controller
    hazardous,   ///< send commands of significance critical and above     director
    rehearse,    ///< start, pace and stop rehearsals                      director
    administer,  ///< users, tokens, audit                                 administrator
};
inline constexpr std::array rights{Right::open,      Right::watch,    Right::command,
                                   Right::hazardous, Right::rehearse, Right::administer};

std::string_view name_of(Role role);
std::string_view name_of(Right right);
std::optional<Role> role_of(std::string_view name);
bool may(Role role, Right right);
/// The least that has it; none: nobody needs a role for it.
std::optional<Role> least_role(Right right);

/// Stands for all programs that bring no browser's secret: of them nobody can say whether they are one person's.
inline constexpr std::string_view no_browser = "none";

/// Who asks.
struct Operator {
    std::string user;                   ///< empty: nobody, or a server without accounts; "token NAME" of a program
    std::optional<Role> role;           ///< none: not logged in
    std::string from;                   ///< address of the peer
    std::vector<std::string> commands;  ///< only these may be sent; empty: all that the role may send
    bool choose_password = false;       ///< nothing but that may be done
    std::string session;                ///< hash of the session's secret; empty: a token, or none
    std::string expires;                ///< ISO 8601; empty: never
    bool accounts = true;               ///< false: the server has none
    std::string browser;  ///< without accounts: hash of the browser's secret, or no_browser; with them empty
};
bool may(const Operator& who, Right right);

}  // namespace aeolis::server
