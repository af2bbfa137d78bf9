// SPDX-License-Identifier: Apache-2.0
#include "server/access/secrets.hpp"

#include "common/check.hpp"

#include <array>
#include <fmt/format.h>
#include <sodium.h>

namespace aeolis::server {
namespace {

void make_ready() {
    static const bool ready = sodium_init() >= 0;
    AEOLIS_CHECK(ready);
}

}  // namespace

Result<void> check_password(const std::string& password) {
    if (password.size() < password_octets_min || password.size() > password_octets_max)
        return Error{fmt::format("password: {} to {} octets are wanted", password_octets_min, password_octets_max)};
    return {};
}

std::string password_hash(const std::string& password) {
    make_ready();
    std::array<char, crypto_pwhash_STRBYTES> text{};
    AEOLIS_CHECK(crypto_pwhash_str_alg(text.data(), password.data(), password.size(),
                                       crypto_pwhash_OPSLIMIT_INTERACTIVE, crypto_pwhash_MEMLIMIT_INTERACTIVE,
                                       crypto_pwhash_ALG_ARGON2ID13) == 0);
    return text.data();
}

bool password_matches(const std::string& hash, const std::string& password) {
    make_ready();
    static const std::string nobody = password_hash(new_secret());
    const bool right =
        crypto_pwhash_str_verify((hash.empty() ? nobody : hash).c_str(), password.data(), password.size()) == 0;
    return right && !hash.empty();
}

std::string new_secret() {
    make_ready();
    std::array<unsigned char, 32> octets{};
    randombytes_buf(octets.data(), octets.size());
    std::array<char, sodium_base64_ENCODED_LEN(octets.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING)> text{};
    sodium_bin2base64(text.data(), text.size(), octets.data(), octets.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    return text.data();
}

std::string secret_hash(const std::string& secret) {
    make_ready();
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(secret.data()), secret.size());
    std::array<char, 2 * hash.size() + 1> text{};
    return sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
}

std::string new_password() {
    make_ready();
    // // 32 characters that are not mistaken for one another.
    constexpr std::string_view letters = "abcdefghjkmnpqrstuvwxyz023456789";
    std::string password;
    for (int i = 0; i < 20; ++i) {
        if (i > 0 && i % 5 == 0) password += '-';
        password += letters[randombytes_uniform(letters.size())];
    }
    return password;
}

}  // namespace aeolis::server
