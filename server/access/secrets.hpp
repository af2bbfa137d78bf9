// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <string>

// Passwords, and secrets that the server makes itself, by libsodium.
namespace aeolis::server {

inline constexpr std::size_t password_octets_min =
    12;  ///< ours: length counts, composition rules do not (NIST SP 800-63B)
inline constexpr std::size_t password_octets_max = 128;  ///< ours

/// An Error says what is wrong with it.
Result<void> check_password(const std::string& password);
/// argon2id with libsodium's interactive limits: 64 MiB and some tenth of a second. Not for the network thread.
std::string password_hash(const std::string& password);
/// As slow as password_hash. An empty hash matches nothing and takes as long: whether a user exists cannot be timed.
bool password_matches(const std::string& hash, const std::string& password);

/// 256 random bits, in 43 letters that a URL may hold.
std::string new_secret();
/// SHA-256, hexadecimal: enough for what has 256 random bits.
std::string secret_hash(const std::string& secret);
/// A password that another gives: 20 letters and figures, 100 random bits.
std::string new_password();

}  // namespace aeolis::server
