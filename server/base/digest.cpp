// SPDX-License-Identifier: Apache-2.0
#include "server/base/digest.hpp"

#include "common/check.hpp"

#include <array>
#include <fmt/format.h>
#include <openssl/evp.h>

namespace aeolis::server {

struct ContextDeleter {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Context = std::unique_ptr<EVP_MD_CTX, ContextDeleter>;

struct Digest::State {
    Context context{EVP_MD_CTX_new()};
};

Digest::Digest() : state_(std::make_unique<State>()) {
    AEOLIS_CHECK(state_->context && EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) == 1);
}
Digest::~Digest() = default;

void Digest::add(std::span<const std::uint8_t> octets) {
    AEOLIS_CHECK(EVP_DigestUpdate(state_->context.get(), octets.data(), octets.size()) == 1);
}

std::string Digest::text() const {
    const Context copy{EVP_MD_CTX_new()};
    std::array<unsigned char, 32> hash{};
    AEOLIS_CHECK(copy && EVP_MD_CTX_copy_ex(copy.get(), state_->context.get()) == 1 &&
                 EVP_DigestFinal_ex(copy.get(), hash.data(), nullptr) == 1);
    std::string text;
    for (const auto octet : hash) fmt::format_to(std::back_inserter(text), "{:02x}", octet);
    return text;
}

}  // namespace aeolis::server
