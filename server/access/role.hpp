// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// The roles, in ascending order: each includes the rights of the one before.
enum class Role : std::uint8_t { observer, controller, director, instructor, administrator };
inline constexpr std::array roles{Role::observer, Role::controller, Role::director, Role::instructor,
                                  Role::administrator};

/// The right that a route, a stream message or a command requires.
enum class Right : std::uint8_t {
    open,        ///< no role needed: log-in itself, the console's files
    watch,       ///< see everything                                       observer
    command,     ///< send commands, acknowledge alarms, write notes       controller
    hazardous,   ///< send commands of significance critical and above     director
    rehearse,    ///< start, pace and stop rehearsals                      director
    instruct,    ///< inject faults, follow a plan, read what is hidden    instructor
    administer,  ///< users, tokens, audit                                 administrator
};
inline constexpr std::array rights{Right::open,     Right::watch,    Right::command,   Right::hazardous,
                                   Right::rehearse, Right::instruct, Right::administer};

std::string_view name_of(Role role);
std::string_view name_of(Right right);
std::optional<Role> role_of(std::string_view name);
bool may(Role role, Right right);
/// The lowest role that has the right; none when no role is needed.
std::optional<Role> least_role(Right right);

/// The `browser` of every program without a browser cookie: two such programs may be one person.
inline constexpr std::string_view no_browser = "none";

/// The identity behind a request.
struct Operator {
    std::string user;                   ///< empty: not logged in, or no accounts; "token NAME" of a program
    std::string owner;                  ///< of a token: the account that it counts as; else empty
    std::optional<Role> role;           ///< none: not logged in
    std::string from;                   ///< address of the peer
    std::vector<std::string> commands;  ///< the only commands allowed; empty: all that the role allows
    bool choose_password = false;       ///< may only choose a new password
    std::string session;                ///< hash of the session's secret; empty: a token, or none
    std::string expires;                ///< ISO 8601; empty: never
    bool accounts = true;               ///< false: the server has no accounts
    std::string browser;                ///< without accounts: hash of the browser's secret, or no_browser; else empty
};
bool may(const Operator& who, Right right);
/// The account that acts, by itself or by one of its tokens.
inline const std::string& person_of(const Operator& who) {
    return who.owner.empty() ? who.user : who.owner;
}

}  // namespace aeolis::server
