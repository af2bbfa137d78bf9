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

unsigned char* written(std::string& octets) {
    return reinterpret_cast<unsigned char*>(octets.data());
}
const unsigned char* read(const std::string& octets) {
    return reinterpret_cast<const unsigned char*>(octets.data());
}

struct KeyPair {
    std::string open = std::string(crypto_sign_PUBLICKEYBYTES, '\0');
    std::string secret = std::string(crypto_sign_SECRETKEYBYTES, '\0');
};
KeyPair keys_of(const std::string& seed) {
    make_ready();
    AEOLIS_CHECK(seed.size() == crypto_sign_SEEDBYTES);
    KeyPair keys;
    AEOLIS_CHECK(crypto_sign_seed_keypair(written(keys.open), written(keys.secret), read(seed)) == 0);
    return keys;
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

std::string drawn_octets(std::size_t octets) {
    make_ready();
    std::string drawn(octets, '\0');
    randombytes_buf(drawn.data(), drawn.size());
    return drawn;
}

std::string new_signing_seed() {
    return drawn_octets(crypto_sign_SEEDBYTES);
}

std::string public_key_of(const std::string& seed) {
    return keys_of(seed).open;
}

std::string signature_of(const std::string& seed, const std::string& octets) {
    const auto keys = keys_of(seed);
    std::string signature(crypto_sign_BYTES, '\0');
    AEOLIS_CHECK(crypto_sign_detached(written(signature), nullptr, read(octets), octets.size(), read(keys.secret)) ==
                 0);
    return signature;
}

bool has_signed(const std::string& public_key, const std::string& octets, const std::string& signature) {
    make_ready();
    return public_key.size() == crypto_sign_PUBLICKEYBYTES && signature.size() == crypto_sign_BYTES &&
           crypto_sign_verify_detached(read(signature), read(octets), octets.size(), read(public_key)) == 0;
}

std::string hexadecimal(const std::string& octets) {
    std::string digits(2 * octets.size() + 1, '\0');
    sodium_bin2hex(digits.data(), digits.size(), read(octets), octets.size());
    digits.pop_back();
    return digits;
}

std::string octets_of_hexadecimal(const std::string& digits) {
    std::string octets(digits.size() / 2, '\0');
    std::size_t size = 0;
    const bool all = digits.size() % 2 == 0 && sodium_hex2bin(written(octets), octets.size(), digits.data(),
                                                              digits.size(), nullptr, &size, nullptr) == 0;
    return all && size == octets.size() ? octets : std::string{};
}

}  // namespace aeolis::server
